// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/base/concat.hpp"
#include "core/draw/sheet.hpp"
#include "core/io/mesh_file.hpp"
#include "core/io/model_file.hpp"
#include "core/modeling/model_source.hpp"
#include "core/modeling/symmetry_search.hpp"
#include "core/pipeline/detector.hpp"
#include "python/src/bind.hpp"
#include "tools/posed_views.hpp"

namespace bpa::python {
namespace {

/// pybind11 has no holder of a const object.
struct Model {
  std::shared_ptr<const ObjectModel> shared;

  const ObjectModel* operator->() const { return shared.get(); }
};

std::shared_ptr<Library> open(const std::string& folder, int num_threads) {
  auto library = std::make_shared<Library>();
  library->folder = folder;
  for (ModelSource& source : or_throw(io::load_library(folder, num_threads))) {
    const std::string name = source.name;
    or_throw(
        library->models.add(or_throw(make_object_model(std::move(source), num_threads), name)));
  }
  library->layers = or_throw(library_score_layers(folder));
  return library;
}

/// What bpa model from-mesh makes of a mesh.
Model model_of(const io::MeshFile& file, const std::string& name, int number, int num_threads,
               const std::string& origin) {
  const py::gil_scoped_release without_gil;
  const modeling::ModelOptions options{.num_threads = num_threads};
  ModelSource source = or_throw(modeling::model_source_from_mesh(file.mesh, name, number, options));
  cli::look_at(file.mesh, cli::kSimulatedViews, {.threads = num_threads}, source);
  source.warnings.insert(source.warnings.end(), file.warnings.begin(), file.warnings.end());
  source.source = origin;
  source.symmetry = modeling::find_symmetries(source.surface, source.diameter, num_threads);
  source.symmetry_origin = SymmetryOrigin::found;
  return {or_throw(make_object_model(std::move(source), num_threads))};
}

Model add(Library& library, const io::MeshFile& file, const std::string& name, int num_threads,
          const std::string& origin) {
  const Model model = model_of(file, name, library.models.next_number(), num_threads, origin);
  or_throw(library.models.add(model.shared));
  library.added.insert(name);
  return model;
}

Model add_mesh(Library& library, const std::string& path, const std::string& name, double scale,
               int num_threads) {
  const auto read = [&] {
    const py::gil_scoped_release without_gil;
    return or_throw(io::read_mesh_file(path, scale));
  };
  return add(library, read(), name, num_threads, path.substr(path.rfind('/') + 1));
}

/// The rows of an array of numbers, (n, 3), as vectors of Out.
template <class In, class Out>
std::vector<Out> rows(const char* name, const py::object& value, const char* rule) {
  const auto array = py::array_t<In, py::array::c_style | py::array::forcecast>::ensure(value);
  if (!array || array.ndim() != 2 || array.shape(1) != 3) refuse(name, value, rule);
  std::vector<Out> out(array.shape(0));
  for (py::ssize_t i = 0; i < array.shape(0); ++i) {
    for (int k = 0; k < 3; ++k) out[i][k] = static_cast<typename Out::value_type>(array.at(i, k));
  }
  return out;
}

Model add_arrays(Library& library, const std::string& name, const py::object& vertices,
                 const py::object& triangles, const py::object& colors, int num_threads) {
  using Color = std::array<std::uint8_t, 3>;
  io::MeshFile file;
  file.mesh.vertices = rows<double, Eigen::Vector3f>("vertices", vertices,
                                                     "an array of numbers of shape (n, 3), metres");
  for (const Eigen::Vector3f& vertex : file.mesh.vertices) {
    if (!vertex.allFinite()) or_throw(invalid_argument("vertices has a NaN or infinite value"));
  }
  const auto corners = rows<std::int64_t, std::array<std::int64_t, 3>>(
      "triangles", triangles, "an array of indices of vertices of shape (m, 3)");
  const auto count = static_cast<std::int64_t>(file.mesh.vertices.size());
  for (const auto& triangle : corners) {
    for (const std::int64_t corner : triangle) {
      if (corner >= 0 && corner < count) continue;
      or_throw(invalid_argument("triangles has the index ", corner, "; it must be from 0 to ",
                                count - 1, ", an index of vertices"));
    }
    const auto& [a, b, c] = triangle;
    file.mesh.triangles.push_back({static_cast<std::uint32_t>(a), static_cast<std::uint32_t>(b),
                                   static_cast<std::uint32_t>(c)});
  }
  if (!colors.is_none()) {
    const auto* rgb = elements<std::uint8_t>(colors, {count, 3});
    if (rgb == nullptr)
      refuse("colors", colors, concat("a uint8 array of shape (", count, ", 3), rgb"));
    for (std::int64_t i = 0; i < count; ++i) {
      file.mesh.colors.push_back(Color{rgb[3 * i], rgb[3 * i + 1], rgb[3 * i + 2]});
    }
  }
  return add(library, file, name, num_threads, "arrays");
}

void save(const Library& shared, const std::string& folder, int num_threads) {
  const Library library = shared;
  const py::gil_scoped_release without_gil;
  for (const auto& model : library.models.models()) {
    const bool is_new = library.added.contains(model->name);
    if (!is_new && folder == library.folder) continue;
    ModelSource source = *model;
    source.prepared = model->index;
    if (!is_new) source.occupancy = or_throw(io::load_occupancy(library.folder, model->name));
    or_throw(io::save_model(folder, source, num_threads));
  }
}

/// Rows of three values of a model, where they are: the array keeps the model alive.
template <class T, class Row>
py::array view(const py::object& model, const std::vector<Row>& rows) {
  static_assert(sizeof(Row) == 3 * sizeof(T));
  py::array_t<T> array({static_cast<py::ssize_t>(rows.size()), py::ssize_t{3}},
                       reinterpret_cast<const T*>(rows.data()), model);
  array.attr("setflags")(py::arg("write") = false);
  return array;
}

/// A property of a model: a view of one of its surface's vectors.
template <class T>
auto surface(auto PointCloud::*member) {
  return [member](const py::object& self) {
    return view<T>(self, self.cast<const Model&>()->surface.*member);
  };
}

}  // namespace

void bind_library(py::module_& module) {
  py::class_<Model>(module, "Model")
      .def_property_readonly("name", [](const Model& m) { return m->name; })
      .def_property_readonly("number", [](const Model& m) { return m->number; })
      .def_property_readonly("diameter", [](const Model& m) { return m->diameter; })
      .def_property_readonly("warnings", [](const Model& m) { return m->warnings; })
      .def_property_readonly("symmetry",
                             [](const Model& m) { return modeling::describe(m->symmetry); })
      .def_property_readonly("points", surface<float>(&PointCloud::points))
      .def_property_readonly("normals", surface<float>(&PointCloud::normals))
      .def_property_readonly("colors", surface<std::uint8_t>(&PointCloud::colors))
      .def("draw",
           [](const Model& m, int side) { return moved(draw::model_thumbnail(*m.shared, side)); })
      .def("png", [](const Model& m) {
        return py::bytes(or_throw(io::encode_color_png(draw::model_thumbnail(*m.shared, 256))));
      });
  py::class_<Library, std::shared_ptr<Library>>(module, "Library")
      .def(py::init<>())
      .def(py::init(&open), WithoutGil())
      .def("models",
           [](const Library& library) {
             std::vector<Model> models;
             for (const auto& model : library.models.models()) models.push_back({model});
             return models;
           })
      .def("add_mesh", &add_mesh)
      .def("add_arrays", &add_arrays)
      .def("remove", [](Library& l, const std::string& name) { or_throw(l.models.remove(name)); })
      .def("save", &save);
}

}  // namespace bpa::python
