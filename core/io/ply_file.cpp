// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
// Not by Assimp, which reads the other formats: 5.2.5 does not return from a truncated binary PLY.
#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cmath>
#include <limits>
#include <optional>
#include <sstream>
#include <string_view>

#include "core/base/concat.hpp"
#include "core/cloud/texture.hpp"
#include "core/io/file_bytes.hpp"
#include "core/io/private/mesh_parts.hpp"

namespace bpa::io {
namespace {

/// A type of number: its two names, its size, and how to read it, in this machine's byte order or
/// swapped.
struct NumberType {
  std::string_view name, other_name;
  std::size_t size;
  bool real;
  double (*read)(const char* bytes, bool swapped);
};

template <class T>
constexpr NumberType number_type(std::string_view name, std::string_view other_name) {
  return {name, other_name, sizeof(T), std::is_floating_point_v<T>,
          [](const char* bytes, bool swapped) {
            std::array<char, sizeof(T)> copy;
            std::copy_n(bytes, sizeof(T), copy.begin());
            if (swapped) std::reverse(copy.begin(), copy.end());
            return static_cast<double>(std::bit_cast<T>(copy));
          }};
}

constexpr NumberType kTypes[] = {
    number_type<std::int8_t>("char", "int8"),    number_type<std::uint8_t>("uchar", "uint8"),
    number_type<std::int16_t>("short", "int16"), number_type<std::uint16_t>("ushort", "uint16"),
    number_type<std::int32_t>("int", "int32"),   number_type<std::uint32_t>("uint", "uint32"),
    number_type<float>("float", "float32"),      number_type<double>("double", "float64")};

/// Null for an unknown name.
const NumberType* find_type(const std::string& name) {
  const auto found = std::find_if(std::begin(kTypes), std::end(kTypes), [&](const NumberType& t) {
    return t.name == name || t.other_name == name;
  });
  return found == std::end(kTypes) ? nullptr : found;
}

constexpr std::size_t kMostElements = 100;  // files have two or three

struct Property {
  std::string name;
  const NumberType* type = nullptr;
  const NumberType* count_type = nullptr;  ///< Of a list.
};

struct Element {
  std::string name;
  std::size_t count = 0;
  std::vector<Property> properties;
};

struct Header {
  std::string format;
  std::vector<Element> elements;
  std::vector<std::string> textures;
  std::size_t size = 0;  ///< Bytes, to the first value.
};

Status parse_property(const std::string& name, std::istringstream& words, Header& header) {
  Property property;
  std::string type;
  words >> type;
  if (type == "list") {
    std::string count_type;
    words >> count_type >> type;
    property.count_type = find_type(count_type);
    if (!property.count_type) return corrupt(name, " has an unknown PLY list type");
  }
  words >> property.name;
  property.type = find_type(type);
  if (!property.type || header.elements.empty()) {
    return corrupt(name, " has a PLY property of unknown type \"", type, "\"");
  }
  header.elements.back().properties.push_back(property);
  return {};
}

Result<Header> parse_header(std::string_view bytes, const std::string& name) {
  Header header;
  std::string key;
  for (bool first = true; key != "end_header"; first = false) {
    const std::size_t end = bytes.find_first_of("\r\n", header.size);
    if (end == std::string::npos)
      return corrupt(name, " is truncated: its PLY header does not end");
    std::istringstream words(std::string(bytes.substr(header.size, end - header.size)));
    header.size = end + (bytes.substr(end, 2) == "\r\n" ? 2 : 1);
    key.clear();
    words >> key;
    if (first && key != "ply") {
      const std::string content = content_of(bytes);
      return corrupt(name, " is not a PLY file", content.empty() ? "" : ", but " + content);
    }
    if (key == "format") {
      words >> header.format;
      if (header.format != "ascii" && header.format != "binary_little_endian" &&
          header.format != "binary_big_endian") {
        return corrupt(name, " has the unknown PLY format \"", header.format, "\"");
      }
    } else if (key == "comment") {
      // "comment TextureFile NAME", as MeshLab writes it.
      std::string word, texture;
      words >> word >> std::ws;
      if (word == "TextureFile" && std::getline(words, texture)) header.textures.push_back(texture);
    } else if (key == "element") {
      Element& element = header.elements.emplace_back();
      words >> element.name >> element.count;
      if (!words) return corrupt(name, " has a PLY element without a count");
      if (header.elements.size() > kMostElements ||
          std::ranges::count(header.elements, element.name, &Element::name) > 1) {
        return corrupt(name, " has PLY element ", element.name, " twice, or more than ",
                       kMostElements, " elements");
      }
    } else if (key == "property") {
      if (Status status = parse_property(name, words, header); !status.ok()) return status;
    }
  }
  return header;
}

/// The numbers of an element, for each property one or, of a list, several.
using Row = std::vector<std::vector<double>>;

/// Reads number after number; after the end of the bytes each is 0 and ok() is false.
class Values {
 public:
  Values(std::string_view bytes, const std::string& format)
      : bytes_(bytes),
        ascii_(format != "binary_little_endian" && format != "binary_big_endian"),
        swapped_(format == "binary_big_endian") {}

  bool ok() const { return ok_; }
  std::size_t remaining() const { return bytes_.size(); }
  /// Whether more stands on the line of a row of text than was read.
  bool line_goes_on() const {
    const std::size_t next = bytes_.find_first_not_of(" \t");
    return ascii_ && next != bytes_.npos && bytes_[next] != '\r' && bytes_[next] != '\n';
  }
  /// Whether all is read, but for what may end a file.
  bool at_end() const {
    return bytes_.find_first_not_of(std::string_view(" \t\r\n\0", 5)) == bytes_.npos;
  }

  void next_row(const Element& element, Row& row) {
    row.resize(element.properties.size());
    for (std::size_t p = 0; p < row.size(); ++p) {
      const Property& property = element.properties[p];
      const double count = property.count_type ? next(*property.count_type) : 1;
      row[p].clear();
      for (double k = 0; k < count && ok_; ++k) row[p].push_back(next(*property.type));
    }
  }

 private:
  double next(const NumberType& type) {
    if (ascii_) return next_word();
    ok_ = ok_ && bytes_.size() >= type.size;
    if (!ok_) return 0;
    const double value = type.read(bytes_.data(), swapped_);
    bytes_.remove_prefix(type.size);
    return value;
  }

  double next_word() {
    constexpr std::string_view kSpaces = " \t\r\n";
    bytes_.remove_prefix(std::min(bytes_.find_first_not_of(kSpaces), bytes_.size()));
    std::string_view word = bytes_.substr(0, bytes_.find_first_of(kSpaces));
    bytes_.remove_prefix(word.size());
    if (word.starts_with('+')) word.remove_prefix(1);
    double value = 0;
    const char* const end = word.data() + word.size();
    const auto read = std::from_chars(word.data(), end, value);
    ok_ = read.ec == std::errc() && read.ptr == end && ok_;
    return value;
  }

  std::string_view bytes_;
  bool ascii_, swapped_;
  bool ok_ = true;
};

/// Where the numbers of a vertex stand in its row: position, normal, colour, texture coordinates,
/// packed colour; -1 for none.
using Columns = std::array<int, 12>;

Columns find_columns(const Element& element) {
  constexpr std::string_view kNames[] = {"x",   "y",     "z",    "nx",        "ny",        "nz",
                                         "red", "green", "blue", "texture_u", "texture_v", "rgba"};
  Columns columns;
  columns.fill(-1);
  for (std::size_t p = 0; p < element.properties.size(); ++p) {
    std::string_view property = element.properties[p].name;
    if (property == "s" || property == "u") property = "texture_u";  // of Blender; of PCL
    if (property == "t" || property == "v") property = "texture_v";
    if (property.starts_with("diffuse_")) property.remove_prefix(8);
    if (property == "r") property = "red";
    if (property == "g") property = "green";
    if (property == "b") property = "blue";
    if (property == "rgb") property = "rgba";  // of PCL, in one whole number
    if (property == "rgba" && element.properties[p].type->real) continue;
    const auto name = std::find(std::begin(kNames), std::end(kNames), property);
    if (name == std::end(kNames) || element.properties[p].count_type) continue;
    columns[name - std::begin(kNames)] = static_cast<int>(p);
  }
  return columns;
}

std::uint8_t color_byte(double value, const NumberType& type) {
  const double scaled = type.real ? 255 * value : value;
  return scaled > 0 ? static_cast<std::uint8_t>(std::lround(std::min(scaled, 255.0)))
                    : 0;  // or NaN
}

/// Nothing where a row has no colour.
std::optional<std::array<std::uint8_t, 3>> color_of(const Element& element, const Columns& columns,
                                                    const Row& row) {
  std::array<std::uint8_t, 3> color{};
  if (const int p = columns[11]; p >= 0) {
    const auto packed = static_cast<std::uint32_t>(static_cast<std::int64_t>(row[p].front()));
    for (std::size_t k = 0; k < 3; ++k) {
      color[k] = static_cast<std::uint8_t>(packed >> (16 - 8 * k));
    }
    return color;
  }
  for (std::size_t k = 0; k < 3; ++k) {
    const int p = columns[6 + k];
    if (p < 0) return std::nullopt;
    color[k] = color_byte(row[p].front(), *element.properties[p].type);
  }
  return color;
}

void add_vertex(const Element& element, const Columns& columns, const Row& row, double scale,
                TriangleMesh& mesh) {
  const auto has = [&](std::size_t first, int count = 3) {
    return std::all_of(&columns[first], &columns[first] + count, [](int p) { return p >= 0; });
  };
  const auto number = [&](std::size_t k) { return columns[k] < 0 ? 0.0 : row[columns[k]].front(); };
  mesh.vertices.push_back(
      Eigen::Vector3d(scale * number(0), scale * number(1), scale * number(2)).cast<float>());
  if (has(3)) {
    const Eigen::Vector3d normal(number(3), number(4), number(5));
    mesh.normals.push_back(normal.stableNormalized().cast<float>());
  }
  if (has(9, 2)) mesh.uv.emplace_back(number(9), number(10));
  if (const auto color = color_of(element, columns, row)) mesh.colors.push_back(*color);
}

/// What faces say of triangles beside their vertices; each empty, or one a triangle.
struct FaceValues {
  std::vector<std::array<Eigen::Vector2f, 3>> uv;  ///< Texture coordinates of the corners.
  std::vector<std::array<std::uint8_t, 3>> colors;
};

bool lists_vertices(const Property& property) {
  return property.count_type &&
         (property.name == "vertex_indices" || property.name == "vertex_index");
}

std::uint32_t vertex_index(double number) {
  constexpr auto kNone = std::numeric_limits<std::uint32_t>::max();
  return number >= 0 && number < kNone ? static_cast<std::uint32_t>(number) : kNone;
}

/// Adds the triangles of a polygon.
void add_face(const Element& element, const Columns& columns, const Row& row, TriangleMesh& mesh,
              FaceValues& values) {
  const auto index_of = [](double number) {
    constexpr double kMany = 1000;  // textures; more are none
    return number >= 0 && number < kMany ? static_cast<int>(number) : -1;
  };
  const std::vector<double> none;
  const std::vector<double>*indices = &none, *uv = &none;
  int texture = 0;
  for (std::size_t p = 0; p < row.size(); ++p) {
    const auto& [name, type, count_type] = element.properties[p];
    if (lists_vertices(element.properties[p])) indices = &row[p];
    if (count_type && name == "texcoord") uv = &row[p];
    if (!count_type && name == "texnumber") texture = index_of(row[p].front());
  }
  const std::vector<double>& of = *indices;
  for (std::size_t k = 2; k < of.size(); ++k) {
    mesh.triangles.push_back({vertex_index(of[0]), vertex_index(of[k - 1]), vertex_index(of[k])});
    mesh.texture_of.push_back(texture);
    if (const auto color = color_of(element, columns, row)) values.colors.push_back(*color);
    if (uv->size() != 2 * of.size()) continue;
    const auto at = [&](std::size_t i) {
      return Eigen::Vector2f(static_cast<float>((*uv)[2 * i]),
                             static_cast<float>((*uv)[2 * i + 1]));
    };
    values.uv.push_back({at(0), at(k - 1), at(k)});
  }
}

/// Adds the triangles of strips, which end with -1; every second one is turned over.
void add_strips(const Element& element, const Row& row, TriangleMesh& mesh) {
  for (std::size_t p = 0; p < row.size(); ++p) {
    if (!lists_vertices(element.properties[p])) continue;
    std::size_t begin = 0;
    for (std::size_t k = 0; k < row[p].size(); ++k) {
      if (row[p][k] < 0) begin = k + 1;
      if (k < begin + 2) continue;
      const bool odd = (k - begin) % 2 != 0;
      mesh.triangles.push_back({vertex_index(row[p][k - (odd ? 1 : 2)]),
                                vertex_index(row[p][k - (odd ? 2 : 1)]), vertex_index(row[p][k])});
      mesh.texture_of.push_back(0);
    }
  }
}

/// Gives each corner of a triangle a vertex of its own, with the values of its face.
void split_corners(const FaceValues& values, TriangleMesh& mesh) {
  const TriangleMesh from = std::move(mesh);
  mesh = {};
  mesh.texture_of = from.texture_of;
  for (std::size_t t = 0; t < from.triangles.size(); ++t) {
    const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
    mesh.triangles.push_back({first, first + 1, first + 2});
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t v = from.triangles[t][k];
      mesh.vertices.push_back(from.vertices[v]);
      if (!from.normals.empty()) mesh.normals.push_back(from.normals[v]);
      if (!from.colors.empty()) mesh.colors.push_back(from.colors[v]);
      if (!values.colors.empty()) mesh.colors.push_back(values.colors[t]);
      if (!values.uv.empty()) mesh.uv.push_back(values.uv[t][k]);
    }
  }
}

/// A property whose name promises colours; empty without one.
std::string color_property(const Header& header) {
  for (const Element& element : header.elements) {
    for (const Property& property : element.properties) {
      for (const char* word : {"color", "colour", "rgb", "red", "material"}) {
        if (property.name.find(word) != std::string::npos) return property.name;
      }
    }
  }
  return "";
}

/// What a header promises that cannot be kept.
Status check_elements(const Header& header, const std::string& name) {
  for (const Element& element : header.elements) {
    const auto has = [&](const char* property) {
      return std::ranges::count(element.properties, property, &Property::name) > 0;
    };
    if (has("f_dc_0") && has("rot_0")) {
      return Status(StatusCode::unsupported,
                    name + " is a Gaussian splat, which has no surface; export a mesh of it");
    }
    if (element.count > 0 && element.properties.empty()) {
      return corrupt(name, " has PLY element ", element.name, " without a property");
    }
    const bool faces = element.name == "face" || element.name == "tristrips";
    if (faces && element.count > 0 && std::ranges::none_of(element.properties, lists_vertices)) {
      return corrupt(name, " has PLY element ", element.name,
                     " without a list vertex_indices or vertex_index");
    }
  }
  return {};
}

Status check_indices(const TriangleMesh& mesh, const std::string& name) {
  for (const auto& triangle : mesh.triangles) {
    for (const std::uint32_t index : triangle) {
      if (index < mesh.vertices.size()) continue;
      return corrupt(name, " has a face with vertex ", index, "; it has only ",
                     mesh.vertices.size(), " vertices");
    }
  }
  return {};
}

}  // namespace

Result<PlyFile> parse_ply_file(std::string_view bytes, const std::string& name, double scale) {
  const Result<Header> header = parse_header(bytes, name);
  if (!header.ok()) return header.status();
  if (Status status = check_elements(*header, name); !status.ok()) return status;
  Values values(bytes.substr(header->size), header->format);
  PlyFile file{{}, header->textures, ""};
  TriangleMesh& mesh = file.mesh;
  FaceValues of_faces;
  Row row;
  for (const Element& element : header->elements) {
    if (element.count > values.remaining() + 1) {
      return corrupt(name, " is truncated: ", element.count, " of PLY element ", element.name,
                     " do not fit");
    }
    const Columns columns = find_columns(element);
    for (std::size_t i = 0; i < element.count; ++i) {
      values.next_row(element, row);
      if (!values.ok()) {
        return corrupt(name, " is truncated or damaged in PLY element ", element.name);
      }
      if (values.line_goes_on()) {
        return corrupt(name, " has more numbers in row ", i + 1, " of PLY element ", element.name,
                       " than its header says; write it as binary PLY");
      }
      if (element.name == "vertex") add_vertex(element, columns, row, scale, mesh);
      if (element.name == "face") add_face(element, columns, row, mesh, of_faces);
      if (element.name == "tristrips") add_strips(element, row, mesh);
    }
  }
  if (!values.at_end()) return corrupt(name, " has more bytes than its PLY header says");
  if (Status status = check_indices(mesh, name); !status.ok()) return status;
  // Of vertices and faces, the vertices' colours are finer.
  const std::size_t triangles = mesh.triangles.size();
  if (of_faces.uv.size() != triangles) of_faces.uv.clear();
  if (of_faces.colors.size() != triangles || !mesh.colors.empty()) of_faces.colors.clear();
  if (!of_faces.uv.empty() || !of_faces.colors.empty()) split_corners(of_faces, mesh);
  if (mesh.uv.empty()) mesh.texture_of.clear();
  if (mesh.colors.empty()) file.unread_color = color_property(*header);
  return file;
}

Result<TriangleMesh> parse_ply(std::string_view bytes, const std::string& name, double scale) {
  Result<PlyFile> file = parse_ply_file(bytes, name, scale);
  if (!file.ok()) return file.status();
  clear_textures(file->mesh);
  return std::move(file->mesh);
}

}  // namespace bpa::io
