// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
// A setting is what the search runs with: read from YAML, named in the result, and in the plan that
// the stages read.
#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "core/base/concat.hpp"
#include "core/base/random.hpp"
#include "core/io/options_yaml.hpp"
#include "core/pipeline/detector.hpp"
#include "tests/support/l_scene.hpp"

namespace bpa {
namespace {

// Another legal value, near the default so that the search takes no longer.
std::string other_value(const Option& option) {
  if (std::holds_alternative<bool*>(option.value)) {
    return io::value_text(option) == "true" ? "false" : "true";
  }
  if (std::holds_alternative<int*>(option.value)) {
    const int usual = *std::get<int*>(option.value);
    return concat(usual + 1 <= option.rule.max ? usual + 1 : usual - 1);
  }
  if (std::holds_alternative<double*>(option.value)) {
    const double usual = *std::get<double*>(option.value);
    const double more = usual == 0 ? 0.25 : 1.25 * usual;
    return concat(more <= option.rule.max ? more : 0.75 * usual);
  }
  return "active_stereo";  // the one text: SurfaceMapOptions::sensor
}

class SettingsOfASearch : public test::LScene {};

TEST_F(SettingsOfASearch, AreTheOnesThatTheUserSets) {
  auto library = std::make_shared<ModelLibrary>();
  ASSERT_TRUE(library->add(l_).ok() && library->add(brick_).ok());
  const Frame frame = test::render(everything(), test::kinect_camera(), 1, 8).frame;
  RandomStream random(2026);
  constexpr int kDraws = 10;
  for (int draw = 0; draw < kDraws; ++draw) {
    DetectorOptions options;
    const std::vector<Option> tree = options_of(options);
    const Option* option = nullptr;
    // Each share of right candidates but the learned ones is refused; see search_plan_test.cpp.
    while (option == nullptr || option->is_group() || option->path == "score.keep_right") {
      option = &tree[static_cast<std::size_t>(random.uniform() * static_cast<double>(tree.size()))];
    }
    const std::string value = other_value(*option);
    ASSERT_NE(value, io::value_text(*option)) << option->path;
    const Status set = io::set_option(option->path + "=" + value, {tree, "-", {}});
    ASSERT_TRUE(set.ok()) << set.message;
    FrameTrace trace;
    const auto result = Detector(library, options).detect(frame, {}, &trace);
    ASSERT_TRUE(result.ok()) << result.status().message;
    const auto named = std::ranges::find(result->plan, option->path, &PlanEntry::name);
    ASSERT_NE(named, result->plan.end()) << option->path;
    EXPECT_EQ(named->reason, "setting") << option->path;
    EXPECT_EQ(named->value, io::value_text(*option)) << option->path;
    DetectorOptions used = trace.plan->settings();
    const auto used_tree = options_of(used);
    const auto used_one = std::ranges::find(used_tree, option->path, &Option::path);
    EXPECT_EQ(io::value_text(*used_one), io::value_text(*option)) << option->path;
  }
}

}  // namespace
}  // namespace bpa
