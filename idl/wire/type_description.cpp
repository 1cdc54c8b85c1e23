// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "idl/wire/type_description.hpp"

#include <algorithm>

#include "idl/wire/sha256.hpp"

namespace bpa::wire {
namespace {

// The text that rosidl_generator_type_description hashes: Python's json.dumps with the separators
// ", " and ": ", keys in this order, default values left out.
std::string to_json(const StructDescription& description) {
  std::string json = R"({"type_name": ")" + description.type + R"(", "fields": [)";
  for (const FieldDescription& field : description.fields) {
    if (&field != &description.fields.front()) json += ", ";
    json += R"({"name": ")" + field.name + R"(", "type": {"type_id": )" +
            std::to_string(field.type_id) + R"(, "capacity": )" + std::to_string(field.capacity) +
            R"(, "string_capacity": )" + std::to_string(field.string_capacity) +
            R"(, "nested_type_name": ")" + field.nested_type + R"("}})";
  }
  return json + "]}";
}

}  // namespace

std::string type_hash(const TypeDescription& description) {
  std::string json = R"({"type_description": )" + to_json(description.type) +
                     R"(, "referenced_type_descriptions": [)";
  for (const StructDescription& referenced : description.referenced) {
    if (&referenced != &description.referenced.front()) json += ", ";
    json += to_json(referenced);
  }
  return "RIHS01_" + sha256_hex(json + "]}");
}

void detail::sort_by_name(std::vector<StructDescription>& structs) {
  std::sort(structs.begin(), structs.end(),
            [](const auto& a, const auto& b) { return a.type < b.type; });
}

}  // namespace bpa::wire
