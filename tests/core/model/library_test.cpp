// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/model/library.hpp"

#include <gtest/gtest.h>

namespace bpa {
namespace {

std::shared_ptr<const ObjectModel> named(const std::string& name, int number) {
  auto model = std::make_shared<ObjectModel>();
  model->name = name;
  model->number = number;
  return model;
}

TEST(ModelLibrary, BeginsEmpty) {
  const ModelLibrary library;
  EXPECT_TRUE(library.empty());
  EXPECT_EQ(library.size(), 0);
  EXPECT_EQ(library.next_number(), 1);
  EXPECT_EQ(library.find("mug"), nullptr);
}

TEST(ModelLibrary, IsOrderedByNumber) {
  ModelLibrary library;
  const std::pair<const char*, int> given[] = {{"mug", 5}, {"bowl", 2}, {"can", 9}, {"jug", 3}};
  for (const auto& [name, number] : given) ASSERT_TRUE(library.add(named(name, number)).ok());
  std::vector<int> numbers;
  for (const auto& model : library.models()) numbers.push_back(model->number);
  EXPECT_EQ(numbers, (std::vector<int>{2, 3, 5, 9}));
  EXPECT_EQ(library.next_number(), 10);
  ASSERT_NE(library.find("can"), nullptr);
  EXPECT_EQ(library.find("can")->number, 9);
  EXPECT_EQ(library.find("ca"), nullptr);
  EXPECT_EQ(library.find("CAN"), nullptr);
}

TEST(ModelLibrary, NamesAndNumbersAreUnique) {
  ModelLibrary library;
  ASSERT_TRUE(library.add(named("mug", 1)).ok());
  EXPECT_EQ(library.add(named("mug", 2)).message, "the library already holds a model named mug");
  EXPECT_EQ(library.add(named("bowl", 1)).message,
            "model bowl has the number 1, which mug has already; numbers must differ");
  EXPECT_EQ(library.add(named("bowl", 1)).code, StatusCode::invalid_argument);
  EXPECT_EQ(library.size(), 1);
}

TEST(ModelLibrary, RemovesByName) {
  ModelLibrary library;
  ASSERT_TRUE(library.add(named("mug", 1)).ok());
  ASSERT_TRUE(library.add(named("bowl", 2)).ok());
  const ModelLibrary copy = library;
  EXPECT_TRUE(library.remove("mug").ok());
  EXPECT_EQ(library.find("mug"), nullptr);
  EXPECT_EQ(library.remove("mug").code, StatusCode::not_found);
  EXPECT_EQ(library.remove("mug").message, "the library holds no model named mug");
  EXPECT_EQ(library.size(), 1);
  EXPECT_NE(copy.find("mug"), nullptr) << "a copy is not touched";
  EXPECT_TRUE(library.add(named("mug", 1)).ok()) << "name and number are free again";
}

}  // namespace
}  // namespace bpa
