// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
// Not by Assimp, which reads OBJ and STL here: 5.2.5 does not return from a truncated binary PLY.
#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstring>
#include <limits>
#include <sstream>
#include <string_view>

#include "core/io/mesh_file.hpp"

namespace bpa::io {
namespace {

enum class Format { ascii, little, big };
enum class Type { i8, u8, i16, u16, i32, u32, f32, f64, unknown };

struct Property {
  std::string name;
  Type type = Type::unknown;
  bool list = false;
  Type count_type = Type::unknown;
};

struct Element {
  std::string name;
  std::size_t count = 0;
  std::vector<Property> properties;
};

struct Header {
  Format format = Format::ascii;
  std::vector<Element> elements;
  std::size_t size = 0;  // bytes, to the first value
};

Type parse_type(std::string_view name) {
  if (name == "char" || name == "int8") return Type::i8;
  if (name == "uchar" || name == "uint8") return Type::u8;
  if (name == "short" || name == "int16") return Type::i16;
  if (name == "ushort" || name == "uint16") return Type::u16;
  if (name == "int" || name == "int32") return Type::i32;
  if (name == "uint" || name == "uint32") return Type::u32;
  if (name == "float" || name == "float32") return Type::f32;
  if (name == "double" || name == "float64") return Type::f64;
  return Type::unknown;
}

Status corrupt(const std::string& name, const std::string& why) {
  return Status(StatusCode::corrupt, name + " " + why);
}

Status parse_property(const std::string& name, std::istringstream& words, Header& header) {
  Property property;
  std::string type;
  words >> type;
  if (type == "list") {
    std::string count_type;
    words >> count_type >> type;
    property.list = true;
    property.count_type = parse_type(count_type);
    if (property.count_type == Type::unknown) return corrupt(name, "has an unknown PLY list type");
  }
  words >> property.name;
  property.type = parse_type(type);
  if (property.type == Type::unknown || header.elements.empty()) {
    return corrupt(name, "has a PLY property of unknown type \"" + type + "\"");
  }
  header.elements.back().properties.push_back(property);
  return {};
}

Result<Header> parse_header(const std::string& bytes, const std::string& name) {
  Header header;
  std::size_t at = 0;
  for (int line_number = 0;; ++line_number) {
    const std::size_t end = bytes.find('\n', at);
    if (end == std::string::npos) return corrupt(name, "is truncated: its PLY header does not end");
    std::istringstream words(bytes.substr(at, end - at));
    at = end + 1;
    std::string key;
    words >> key;
    if (line_number == 0) {
      if (key != "ply") return corrupt(name, "is not a PLY file");
    } else if (key == "format") {
      words >> key;
      if (key == "ascii") {
        header.format = Format::ascii;
      } else if (key == "binary_little_endian") {
        header.format = Format::little;
      } else if (key == "binary_big_endian") {
        header.format = Format::big;
      } else {
        return corrupt(name, "has the unknown PLY format \"" + key + "\"");
      }
    } else if (key == "element") {
      Element element;
      words >> element.name >> element.count;
      if (!words) return corrupt(name, "has a PLY element without a count");
      header.elements.push_back(element);
    } else if (key == "property") {
      if (Status status = parse_property(name, words, header); !status.ok()) return status;
    } else if (key == "end_header") {
      header.size = at;
      return header;
    }
  }
}

/// Reads value after value; after the end of the bytes every value is 0 and ok() is false.
class Values {
 public:
  Values(std::string_view bytes, Format format) : bytes_(bytes), format_(format) {}

  bool ok() const { return ok_; }
  std::size_t remaining() const { return bytes_.size() - at_; }

  double next(Type type) {
    if (format_ == Format::ascii) return next_word();
    switch (type) {
      case Type::i8:
        return raw<std::int8_t>();
      case Type::u8:
        return raw<std::uint8_t>();
      case Type::i16:
        return raw<std::int16_t>();
      case Type::u16:
        return raw<std::uint16_t>();
      case Type::i32:
        return raw<std::int32_t>();
      case Type::u32:
        return raw<std::uint32_t>();
      case Type::f32:
        return static_cast<double>(raw<float>());
      default:
        return raw<double>();
    }
  }

 private:
  template <class T>
  T raw() {
    T value{};
    if (remaining() < sizeof(T)) {
      ok_ = false;
      at_ = bytes_.size();
      return value;
    }
    char buffer[sizeof(T)];
    std::memcpy(buffer, bytes_.data() + at_, sizeof(T));
    at_ += sizeof(T);
    const bool swap = (format_ == Format::big) != (std::endian::native == std::endian::big);
    if (swap) std::reverse(buffer, buffer + sizeof(T));
    std::memcpy(&value, buffer, sizeof(T));
    return value;
  }

  double next_word() {
    constexpr std::string_view kSpaces = " \t\r\n";
    const std::size_t start = bytes_.find_first_not_of(kSpaces, at_);
    if (start == std::string_view::npos) {
      ok_ = false;
      at_ = bytes_.size();
      return 0;
    }
    at_ = std::min(bytes_.find_first_of(kSpaces, start), bytes_.size());
    double value = 0;
    const char* first = bytes_.data() + start;
    if (*first == '+') ++first;
    ok_ = std::from_chars(first, bytes_.data() + at_, value).ec == std::errc() && ok_;
    return value;
  }

  std::string_view bytes_;
  Format format_;
  std::size_t at_ = 0;
  bool ok_ = true;
};

/// Which slot of a vertex a property fills: 0-2 position, 3-5 normal, 6-8 colour, 9 none.
int vertex_slot(const std::string& name) {
  constexpr std::string_view kNames[] = {"x", "y", "z", "nx", "ny", "nz", "red", "green", "blue"};
  for (int i = 0; i < 9; ++i) {
    if (name == kNames[i]) return i;
  }
  return 9;
}

std::uint8_t color_byte(double value, Type type) {
  const double scaled = type == Type::f32 || type == Type::f64 ? 255 * value : value;
  return static_cast<std::uint8_t>(std::clamp(std::round(scaled), 0.0, 255.0));
}

void read_vertices(const Element& element, Values& values, double scale, TriangleMesh& mesh) {
  bool has[10] = {};
  for (const Property& property : element.properties) has[vertex_slot(property.name)] = true;
  for (std::size_t i = 0; i < element.count && values.ok(); ++i) {
    double vertex[10] = {};
    std::array<std::uint8_t, 3> color{};
    for (const Property& property : element.properties) {
      const int slot = vertex_slot(property.name);
      if (property.list) {
        const double count = values.next(property.count_type);
        for (double k = 0; k < count && values.ok(); ++k) values.next(property.type);
        continue;
      }
      vertex[slot] = values.next(property.type);
      if (slot >= 6 && slot < 9)
        color[static_cast<std::size_t>(slot - 6)] = color_byte(vertex[slot], property.type);
    }
    mesh.vertices.push_back(
        Eigen::Vector3d(scale * vertex[0], scale * vertex[1], scale * vertex[2]).cast<float>());
    if (has[3] && has[4] && has[5]) {
      const Eigen::Vector3d normal(vertex[3], vertex[4], vertex[5]);
      mesh.normals.push_back(normal.stableNormalized().cast<float>());
    }
    if (has[6] && has[7] && has[8]) mesh.colors.push_back(color);
  }
}

void read_faces(const Element& element, Values& values, TriangleMesh& mesh) {
  std::vector<std::uint32_t> polygon;
  for (std::size_t i = 0; i < element.count && values.ok(); ++i) {
    for (const Property& property : element.properties) {
      if (!property.list) {
        values.next(property.type);
        continue;
      }
      polygon.clear();
      const double count = values.next(property.count_type);
      for (double k = 0; k < count && values.ok(); ++k) {
        const double index = values.next(property.type);
        polygon.push_back(index >= 0 && index < std::numeric_limits<std::uint32_t>::max()
                              ? static_cast<std::uint32_t>(index)
                              : std::numeric_limits<std::uint32_t>::max());
      }
      if (property.name != "vertex_indices" && property.name != "vertex_index") continue;
      for (std::size_t k = 2; k < polygon.size(); ++k) {
        mesh.triangles.push_back({polygon[0], polygon[k - 1], polygon[k]});
      }
    }
  }
}

void skip_element(const Element& element, Values& values) {
  for (std::size_t i = 0; i < element.count && values.ok(); ++i) {
    for (const Property& property : element.properties) {
      const double count = property.list ? values.next(property.count_type) : 1;
      for (double k = 0; k < count && values.ok(); ++k) values.next(property.type);
    }
  }
}

}  // namespace

Result<TriangleMesh> parse_ply(const std::string& bytes, const std::string& name, double scale) {
  const Result<Header> header = parse_header(bytes, name);
  if (!header.ok()) return header.status();
  Values values(std::string_view(bytes).substr(header->size), header->format);
  TriangleMesh mesh;
  for (const Element& element : header->elements) {
    if (element.count > values.remaining() + 1) {
      return corrupt(name, "is truncated: " + std::to_string(element.count) + " of PLY element " +
                               element.name + " do not fit");
    }
    if (element.name == "vertex") {
      read_vertices(element, values, scale, mesh);
    } else if (element.name == "face") {
      read_faces(element, values, mesh);
    } else {
      skip_element(element, values);
    }
    if (!values.ok()) {
      return corrupt(name, "is truncated or damaged in PLY element " + element.name);
    }
  }
  for (const auto& triangle : mesh.triangles) {
    for (const std::uint32_t index : triangle) {
      if (index >= mesh.vertices.size()) {
        return corrupt(name, "has a face with vertex " + std::to_string(index) + "; it has only " +
                                 std::to_string(mesh.vertices.size()) + " vertices");
      }
    }
  }
  return mesh;
}

}  // namespace bpa::io
