// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
// What the core accepts or finds reaches the other members of a group as it is. Values are drawn at
// random from all that the core's own checks let through.
#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "core/base/random.hpp"
#include "core/modeling/model_source.hpp"
#include "idl/wire/cdr.hpp"
#include "server/group/messages.hpp"
#include "tests/support/meshes.hpp"

namespace bpa::server::group {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

// The bits, so that NaN equals itself.
template <class Values>
std::string bits(const Values& values) {
  return {reinterpret_cast<const char*>(values.data()), sizeof(*values.data()) * values.size()};
}

template <class Message>
Message over_the_wire(const Message& sent) {
  std::vector<std::uint8_t> bytes(wire::encoded_size(sent));
  wire::encode(sent, bytes.data(), bytes.size());
  Message got;
  EXPECT_TRUE(wire::decode(bytes.data(), bytes.size(), got).ok());
  return got;
}

class Draw {
 public:
  explicit Draw(std::uint64_t seed) : random_(seed) {}

  bool chance(double share) { return random_.uniform() < share; }
  int count(int least, int most) { return least + random_.index(most - least + 1); }
  std::uint64_t bits() { return random_(); }
  double number(double low, double high) { return random_.uniform(low, high); }

  // Now and then one of the values that a double may have besides numbers.
  double any_double() {
    constexpr double kSpecial[] = {
        0, -0.0, kInfinity, -kInfinity, std::numeric_limits<double>::quiet_NaN(), 5e-324, 1.7e308};
    return chance(0.3) ? kSpecial[random_.index(7)] : 100 * random_.normal();
  }
  Pose pose() {
    Eigen::Vector4d q;
    for (double& x : q) x = random_.normal();
    return {Eigen::Quaterniond(q.normalized()),
            {random_.normal(), random_.normal(), 1e3 * random_.normal()}};
  }
  std::vector<std::uint8_t> bytes(std::size_t size) {
    std::vector<std::uint8_t> out(size);
    for (std::uint8_t& byte : out) byte = static_cast<std::uint8_t>(random_());
    return out;
  }

  Frame frame() {
    Frame out;
    Camera& camera = out.camera;
    camera.width = count(32, 70);
    camera.height = count(32, 70);
    camera.fx = std::exp(number(-9, 13));
    camera.fy = std::exp(number(-9, 13));
    camera.cx = number(-0.9, 1.9) * camera.width;
    camera.cy = number(-0.9, 1.9) * camera.height;
    const auto pixels = static_cast<std::size_t>(camera.width * camera.height);
    for (std::size_t i = 0; i < pixels; ++i) {
      out.depth.push_back(static_cast<float>(chance(0.2) ? any_double() : number(1e-3, 20)));
    }
    if (chance(0.5)) out.color = bytes(3 * pixels);
    if (chance(0.5)) out.mask = bytes(pixels);
    if (chance(0.5)) out.background = bytes(pixels);
    if (chance(0.5)) {
      out.roi = {count(0, 15), count(0, 15), count(1, 16), count(1, 16)};
    } else {
      out.roi = {count(-9, 9), count(-9, 9), count(-9, 0), count(-9, 9)};  // the whole image
    }
    out.frame_id = std::string(static_cast<std::size_t>(count(0, 300)), 'f');
    out.fused = count(1, 1000);
    return out;
  }

  PosePrior prior() {
    PosePrior out;
    out.model = chance(0.5) ? "brick" : "plate";
    if (chance(0.5)) {
      const Eigen::Matrix3d turn = pose().matrix();
      const Eigen::Vector3d variances(number(1e-9, 1), number(1e-9, 1), number(1e-9, 1));
      Eigen::Matrix3d covariance = turn * variances.asDiagonal() * turn.transpose();
      if (chance(0.5)) covariance = 0.5 * (covariance + covariance.transpose()).eval();
      out.position = PositionPrior{pose().translation, covariance};
    }
    if (chance(0.5)) {
      const auto spread =
          orientation_uncertainty(pose().rotation, number(1e-4, 1) * Eigen::Matrix3d::Identity());
      out.orientation = spread;
      if (chance(0.5)) out.orientation.concentrations[2] = 0;
    } else {
      out.orientation.axes.fill(any_double());  // does not count
    }
    out.weight = chance(0.2) ? 1 : number(1e-12, 1);
    return out;
  }

  DetectRequest request() {
    DetectRequest out;
    for (int left = count(0, 4); left > 0; --left) out.priors.push_back(prior());
    for (int left = count(0, 4); left > 0; --left) {
      out.expected.push_back({chance(0.5) ? "brick" : "plate", pose()});
    }
    out.top_k = count(1, 100);
    out.budget_ms = chance(0.3) ? (chance(0.5) ? 0 : kInfinity) : std::exp(number(-700, 700));
    out.seed = bits();
    return out;
  }

  void set(const Option& option) {
    const FieldRule& rule = option.rule;
    if (auto* const* flag = std::get_if<bool*>(&option.value)) {
      **flag = chance(0.5);
    } else if (auto* const* whole = std::get_if<int*>(&option.value)) {
      constexpr double kMost = std::numeric_limits<int>::max();
      **whole = count(static_cast<int>(std::max(rule.min, -1.0)),
                      static_cast<int>(std::min(rule.max, kMost) - 2));
    } else if (auto* const* real = std::get_if<double*>(&option.value)) {
      const double low = std::max(rule.min, -1e300), high = std::min(rule.max, 1e300);
      **real = chance(0.2) ? (chance(0.5) ? rule.min : rule.max) : number(low, high);
    } else if (auto* const* text = std::get_if<std::string*>(&option.value)) {
      const auto first = rule.choices.substr(0, rule.choices.find(' '));
      const auto rest = rule.choices.substr(std::min(first.size() + 1, rule.choices.size()));
      **text = rule.choices.empty() ? "a \"b\": [#\n"
               : chance(0.5)        ? first
                                    : rest.substr(0, rest.find(' '));
    } else if (auto* const* list = std::get_if<std::vector<std::string>*>(&option.value)) {
      **list = {"", "a, b", "- c"};
    }
  }

  detect::Candidate candidate(const ObjectModel& model, std::size_t pixels) {
    detect::Candidate out{.model = &model};
    out.refinement.frame_from_object = pose();
    for (double& entry : out.refinement.information.reshaped()) entry = number(-1e9, 1e9);
    out.refinement.num_correspondences = count(0, 100000);
    out.found_by =
        static_cast<detect::Source>(random_.index(static_cast<int>(detect::Source::count)));
    for (double& value : out.values) value = any_double();
    out.prior = number(-100, 100);
    out.score = number(-100, 100);
    out.probability = number(0, 1);
    for (std::uint32_t pixel = 0; pixel < pixels; ++pixel) {
      if (chance(0.3)) out.explained.push_back(pixel);
    }
    return out;
  }

 private:
  RandomStream random_;
};

class GroupMessages : public testing::Test {
 protected:
  GroupMessages() {
    int number = 0;
    for (const char* name : {"brick", "plate"}) {
      auto source =
          modeling::model_source_from_mesh(test::box_mesh({0.03f, 0.02f, 0.01f}), name, ++number);
      EXPECT_TRUE(source.ok());
      auto model = make_object_model(*std::move(source));
      EXPECT_TRUE(model.ok() && library_.models.add(*model).ok());
    }
  }

  /// For both models.
  wire::bpa_msgs::GroupTask message_of(const Frame& frame, const DetectRequest& request,
                                       const DetectorOptions& options) const {
    auto message = task_message(frame, request, options, library_);
    message.models = {1, 2};
    message.budget_ms = request.budget_ms;
    return message;
  }

  SharedLibrary library_;
};

void expect_equal(const DetectRequest& got, const DetectRequest& sent) {
  EXPECT_EQ(got.seed, sent.seed);
  EXPECT_EQ(got.budget_ms, sent.budget_ms);
  ASSERT_EQ(got.priors.size(), sent.priors.size());
  for (std::size_t i = 0; i < sent.priors.size(); ++i) {
    const PosePrior &a = got.priors[i], &b = sent.priors[i];
    EXPECT_EQ(a.model, b.model);
    EXPECT_EQ(a.weight, b.weight);
    ASSERT_EQ(a.position.has_value(), b.position.has_value());
    if (a.position) {
      EXPECT_EQ(a.position->mean, b.position->mean);
      EXPECT_EQ(a.position->covariance, b.position->covariance);
    }
    EXPECT_EQ(bits(a.orientation.axes), bits(b.orientation.axes));
    EXPECT_EQ(a.orientation.concentrations, b.orientation.concentrations);
  }
  ASSERT_EQ(got.expected.size(), sent.expected.size());
  for (std::size_t i = 0; i < sent.expected.size(); ++i) {
    EXPECT_EQ(got.expected[i].model, sent.expected[i].model);
    const Pose &a = got.expected[i].frame_from_object, &b = sent.expected[i].frame_from_object;
    EXPECT_EQ(a.rotation.coeffs(), b.rotation.coeffs());
    EXPECT_EQ(a.translation, b.translation);
  }
}

void expect_equal(const Frame& got, const Frame& sent) {
  EXPECT_EQ(bits(got.depth), bits(sent.depth));
  EXPECT_EQ(got.color, sent.color);
  EXPECT_EQ(got.mask, sent.mask);
  EXPECT_EQ(got.background, sent.background);
  EXPECT_EQ(got.roi.empty(), sent.roi.empty());
  if (!sent.roi.empty()) {
    EXPECT_EQ(got.roi, sent.roi);
  }
  EXPECT_EQ(got.frame_id, sent.frame_id);
  EXPECT_EQ(got.fused, sent.fused);
  const auto numbers = [](const Camera& c) {
    return std::vector<double>{
        static_cast<double>(c.width), static_cast<double>(c.height), c.fx, c.fy, c.cx, c.cy};
  };
  EXPECT_EQ(numbers(got.camera), numbers(sent.camera));
}

TEST_F(GroupMessages, SearchThatTheCoreAcceptsArrivesAsItIs) {
  Draw draw(2026);
  for (int k = 0; k < 300; ++k) {
    const Frame frame = draw.frame();
    const DetectRequest request = draw.request();
    DetectorOptions options;
    for (const Option& option : options_of(options)) draw.set(option);
    options.detect.score.keep_right = draw.chance(0.5) ? 1 : 0.999;  // any other has no limits
    Status accepted = validate(frame);
    if (accepted.ok()) accepted = validate(request);
    if (accepted.ok()) accepted = validate(options);
    ASSERT_TRUE(accepted.ok()) << accepted.message;

    const auto message = over_the_wire(message_of(frame, request, options));
    const auto task = task_from(message, library_);
    ASSERT_TRUE(task.ok()) << task.status().message;
    expect_equal(task->frame, frame);
    expect_equal(task->request, request);
    auto read = options_from(message.options);
    ASSERT_TRUE(read.ok()) << read.status().message;
    const auto sent = options_of(options), got = options_of(*read);
    ASSERT_EQ(got.size(), sent.size());
    for (std::size_t i = 0; i < sent.size(); ++i) {
      const auto same = [&](auto* value) {
        return *value == *std::get<decltype(value)>(got[i].value);
      };
      const bool equal =
          sent[i].is_group() || std::visit(
                                    [&](auto value) {
                                      if constexpr (std::is_pointer_v<decltype(value)>)
                                        return same(value);
                                      return true;
                                    },
                                    sent[i].value);
      EXPECT_TRUE(equal) << sent[i].path;
    }
  }
}

TEST_F(GroupMessages, WhatTheCoreRefusesIsRefusedInItsWords) {
  Draw draw(7);
  const Frame frame = draw.frame();
  const auto refusal = [&](const DetectRequest& request) {
    const Status refused = task_from(message_of(frame, request, {}), library_).status();
    EXPECT_EQ(refused.message, validate(request).message);
    return refused.code;
  };
  EXPECT_EQ(refusal({}), StatusCode::ok);
  DetectRequest request;
  request.expected = {{"brick", draw.pose()}};
  request.expected[0].frame_from_object.rotation.w() += 1;
  EXPECT_EQ(refusal(request), StatusCode::invalid_argument);
  request = {};
  request.budget_ms = -1;
  EXPECT_EQ(refusal(request), StatusCode::invalid_argument);
  request = {};
  request.priors = {draw.prior()};
  request.priors[0].weight = 0;
  EXPECT_EQ(refusal(request), StatusCode::invalid_argument);
  Frame small = frame;
  small.depth.pop_back();
  EXPECT_EQ(task_from(message_of(small, {}, {}), library_).status().message,
            validate(small).message);
}

TEST_F(GroupMessages, AnyCandidateArrivesAsItIs) {
  Draw draw(5);
  constexpr std::size_t kPixels = 200;
  for (int k = 0; k < 1000; ++k) {
    const detect::Candidate sent =
        draw.candidate(*library_.models.models()[draw.count(0, 1)], kPixels);
    const auto got = candidate_from(over_the_wire(to_message(sent)), *sent.model, kPixels);
    ASSERT_TRUE(got.ok()) << got.status().message;
    EXPECT_EQ(got->pose().rotation.coeffs(), sent.pose().rotation.coeffs());
    EXPECT_EQ(got->pose().translation, sent.pose().translation);
    EXPECT_EQ(bits(got->refinement.information), bits(sent.refinement.information));
    EXPECT_EQ(got->refinement.num_correspondences, sent.refinement.num_correspondences);
    EXPECT_EQ(got->found_by, sent.found_by);
    EXPECT_EQ(bits(got->values), bits(sent.values));
    const std::array<double, 3> got_scores{got->prior, got->score, got->probability};
    EXPECT_EQ(bits(got_scores), bits(std::array{sent.prior, sent.score, sent.probability}));
    EXPECT_EQ(got->explained, sent.explained);
  }
}

}  // namespace
}  // namespace bpa::server::group
