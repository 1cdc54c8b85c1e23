// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "tools/search.hpp"

#include <gtest/gtest.h>

#include "tests/support/temporary_folder.hpp"

namespace bpa::cli {
namespace {

TEST(NumberTruth, ByTheNamesOfTheLibrary) {
  const test::TemporaryFolder folder;
  test::spill(folder / "models/models_info.json",
              R"({"1": {"name": "mug", "diameter": 100}, "2": {"name": "drill", "diameter": 200},
                  "3": {"name": "spoon", "diameter": 200}})");
  ModelLibrary library;
  for (const auto& [number, name] : {std::pair(1, "banana"), {2, "mug"}}) {
    auto model = std::make_shared<ObjectModel>();
    model->number = number;
    model->name = name;
    ASSERT_TRUE(library.add(model).ok());
  }
  std::vector<io::BopFrame> frames(1);
  frames[0].truth.resize(2);
  frames[0].truth[0].obj_id = 1;
  frames[0].truth[1].obj_id = 2;
  ::testing::internal::CaptureStderr();
  number_truth(folder.path(), library, true, frames);
  EXPECT_EQ(::testing::internal::GetCapturedStderr(),
            "warning: " + folder.path() + ": the library lacks objects of its truth: drill\n");
  EXPECT_EQ(frames[0].truth[0].obj_id, 2);
  EXPECT_EQ(frames[0].truth[1].obj_id, -1);
}

}  // namespace
}  // namespace bpa::cli
