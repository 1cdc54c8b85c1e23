// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "tools/mesh_input.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cstdio>
#include <filesystem>

namespace bpa::cli {
namespace {

struct LengthUnit {
  const char* option;
  const char* name;
  double metres;
};

constexpr LengthUnit kMetre{"m", "metres", 1};
constexpr LengthUnit kCentimetre{"cm", "centimetres", 0.01};
constexpr LengthUnit kMillimetre{"mm", "millimetres", 0.001};
constexpr LengthUnit kInch{"in", "inches", 0.0254};
constexpr LengthUnit kUnits[] = {kMetre, kCentimetre, kMillimetre, kInch};

Eigen::Vector3f size_of(const TriangleMesh& mesh) {
  Eigen::AlignedBox3f box;
  for (const Eigen::Vector3f& vertex : mesh.vertices) box.extend(vertex);
  return box.isEmpty() ? Eigen::Vector3f(0, 0, 0) : Eigen::Vector3f(box.sizes());
}

const LengthUnit& guess(double largest) {
  constexpr double kLargestMetres = 3;         // the largest model, metres
  constexpr double kSmallestMillimetres = 20;  // smaller objects are rare; 3 to 20 cm are not
  if (largest <= kLargestMetres) return kMetre;
  return largest < kSmallestMillimetres ? kCentimetre : kMillimetre;
}

void print_assumption(const std::string& path, const LengthUnit& unit, const TriangleMesh& mesh) {
  const Eigen::Vector3d size = (1000 * size_of(mesh)).cast<double>();
  std::printf("%s: assuming %s: %.0f x %.0f x %.0f mm; --unit or --scale says otherwise\n",
              std::filesystem::path(path).filename().c_str(), unit.name, size.x(), size.y(),
              size.z());
}

}  // namespace

void add_unit_options(CLI::App& command, double& scale) {
  auto* factor = command.add_option("--scale", scale,
                                    "Metres of one unit of the file, 0.001 for millimetres; of "
                                    "glTF and DAE, a factor on the metres that the file says");
  factor->check(CLI::PositiveNumber);
  const auto set = [&scale](const std::string& name) {
    const auto* unit =
        std::ranges::find(kUnits, name, [](const LengthUnit& u) { return std::string(u.option); });
    scale = unit->metres;
  };
  command
      .add_option_function<std::string>(
          "--unit", set,
          "The same by name. Guessed from the size of the object if neither is given")
      ->check(CLI::IsMember({"m", "cm", "mm", "in"}))
      ->excludes(factor);
}

double guess_unit(double largest) { return guess(largest).metres; }

std::vector<io::MeshFile> read_meshes(const std::vector<std::string>& paths, double& scale) {
  std::vector<io::MeshFile> files;
  double largest = 0;
  for (const std::string& path : paths) {
    files.push_back(or_throw(io::read_mesh_file(path, scale > 0 ? scale : 1.0)));
    if (files.back().metres) continue;
    largest = std::max(largest, static_cast<double>(size_of(files.back().mesh).maxCoeff()));
  }
  if (scale > 0 || largest == 0) return files;
  const LengthUnit& unit = guess(largest);
  scale = unit.metres;
  for (std::size_t i = 0; i < files.size(); ++i) {
    if (files[i].metres) continue;
    for (Eigen::Vector3f& vertex : files[i].mesh.vertices) {
      vertex = (scale * vertex.cast<double>()).cast<float>();
    }
    print_assumption(paths[i], unit, files[i].mesh);
  }
  return files;
}

}  // namespace bpa::cli
