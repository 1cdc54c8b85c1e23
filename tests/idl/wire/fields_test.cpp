// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
// The C++ structs against idl/dds.idl, which is made from the .idl files of every type.
#include <fstream>
#include <map>
#include <sstream>
#include <string>

#include <gtest/gtest.h>

#include "idl/wire/names.hpp"
#include "tests/idl/wire/all_types.hpp"
#include "tests/idl/wire/description.hpp"

namespace bpa::wire {
namespace {

std::string dds_idl() {
  std::ifstream file(BPA_SOURCE_DIR "/idl/dds.idl");
  std::stringstream text;
  text << file.rdbuf();
  return text.str();
}

std::string element_name(const FieldDescription& field, int id) {
  static const std::map<int, std::string> kNames = {
      {2, "int8"},     {3, "uint8"},  {4, "int16"},  {5, "uint16"}, {6, "int32"},
      {7, "uint32"},   {8, "int64"},  {9, "uint64"}, {10, "float"}, {11, "double"},
      {15, "boolean"}, {16, "octet"}, {17, "string"}};
  if (id == 1) return dds_type_name(field.nested_type);
  if (id == 21) return "string<" + std::to_string(field.string_capacity) + ">";
  return kNames.at(id);
}

/// A struct as dds.idl has it.
std::string idl_of(const StructDescription& description) {
  const std::size_t slash = description.type.rfind('/');
  std::string text = "    struct " + description.type.substr(slash + 1) + "_ {\n";
  for (const FieldDescription& field : description.fields) {
    const std::string element = element_name(field, field.type_id % 48);
    const std::string count = std::to_string(field.capacity);
    const int form = field.type_id / 48;  // plain, array, bounded sequence, sequence
    std::string type = element;
    if (form == 2) type = "sequence<" + element + ", " + count + ">";
    if (form == 3) type = "sequence<" + element + ">";
    text += "      " + type + " " + field.name + (form == 1 ? "[" + count + "]" : "") + ";\n";
  }
  return text + "    };\n";
}

TEST(Fields, AreThoseOfTheIdl) {
  const std::string idl = dds_idl();
  ASSERT_FALSE(idl.empty());
  std::size_t types = 0;
  for_each_type([&](const auto* type) {
    using T = std::decay_t<decltype(*type)>;
    const std::string text = idl_of(describe<T>());
    EXPECT_NE(idl.find(text), std::string::npos) << T::kType << " is not in dds.idl as\n" << text;
    ++types;
  });
  std::size_t structs = 0;
  for (std::size_t at = idl.find("struct "); at != std::string::npos;
       at = idl.find("struct ", at + 1))
    ++structs;
  EXPECT_EQ(types, structs) << "a type of dds.idl is missing in all_types.hpp";
}

}  // namespace
}  // namespace bpa::wire
