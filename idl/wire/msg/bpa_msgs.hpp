// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "idl/wire/field.hpp"
#include "idl/wire/msg/geometry_msgs.hpp"
#include "idl/wire/msg/sensor_msgs.hpp"
// Our own messages. What the fields mean, their units, frames and when they may be empty is said
// once, in idl/bpa_msgs/msg/*.msg and srv/*.srv.

namespace bpa::wire::bpa_msgs {

/// How a request or a frame fared; the codes are those of bpa::StatusCode.
struct Status {
  static constexpr const char* kType = "bpa_msgs/msg/Status";
  std::uint8_t code = 0;
  std::string message;

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor&& visit) {
    visit("code", self.code);
    visit("message", self.message);
  }
};

struct Bingham {
  static constexpr const char* kType = "bpa_msgs/msg/Bingham";
  std::array<double, 12> axes{};           ///< Three unit 4-vectors (w, x, y, z).
  std::array<double, 3> concentrations{};  ///< Ascending, <= 0.

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor&& visit) {
    visit("axes", self.axes);
    visit("concentrations", self.concentrations);
  }
};

struct PosePrior {
  static constexpr const char* kType = "bpa_msgs/msg/PosePrior";
  std::string model;
  geometry_msgs::Pose pose;
  Bingham orientation;
  std::array<double, 9> position_covariance{};  ///< m^2; all zero: position unknown.
  double weight = 0;                            ///< That it is true; 0: 0.95.

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor&& visit) {
    visit("model", self.model);
    visit("pose", self.pose);
    visit("orientation", self.orientation);
    visit("position_covariance", self.position_covariance);
    visit("weight", self.weight);
  }
};

/// `Bytes` is std::vector<std::uint8_t> or, to publish images without copying them, ByteView.
template <class Bytes>
struct BasicRgbdFrame {
  static constexpr const char* kType = "bpa_msgs/msg/RgbdFrame";
  std_msgs::Header header;
  std::uint32_t width = 0;
  std::uint32_t height = 0;
  std::string color_encoding;
  Bytes color;
  std::string depth_encoding;
  Bytes depth;
  std::array<double, 9> k{};
  std::vector<double> d;
  sensor_msgs::RegionOfInterest roi;
  Bytes mask;
  std::vector<PosePrior> priors;

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor&& visit) {
    visit("header", self.header);
    visit("width", self.width);
    visit("height", self.height);
    visit("color_encoding", self.color_encoding);
    visit("color", self.color);
    visit("depth_encoding", self.depth_encoding);
    visit("depth", self.depth);
    visit("k", self.k);
    visit("d", self.d);
    visit("roi", self.roi);
    visit("mask", self.mask);
    visit("priors", self.priors);
  }
};

using RgbdFrame = BasicRgbdFrame<std::vector<std::uint8_t>>;
using RgbdFrameView = BasicRgbdFrame<ByteView>;

struct ScoreComponent {
  static constexpr const char* kType = "bpa_msgs/msg/ScoreComponent";
  std::string name;
  double value = 0;

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor&& visit) {
    visit("name", self.name);
    visit("value", self.value);
  }
};

struct PoseAlternative {
  static constexpr const char* kType = "bpa_msgs/msg/PoseAlternative";
  geometry_msgs::Pose pose;
  double weight = 0;

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor&& visit) {
    visit("pose", self.pose);
    visit("weight", self.weight);
  }
};

struct Placement {
  static constexpr const char* kType = "bpa_msgs/msg/Placement";
  std::string model;
  std::uint32_t model_number = 0;
  std::uint32_t instance = 0;
  geometry_msgs::PoseWithCovariance pose;
  Bingham orientation;
  double score = 0;
  double probability = 0;
  double visible_fraction = 0;
  std::vector<ScoreComponent> score_components;
  std::vector<PoseAlternative> alternatives;

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor&& visit) {
    visit("model", self.model);
    visit("model_number", self.model_number);
    visit("instance", self.instance);
    visit("pose", self.pose);
    visit("orientation", self.orientation);
    visit("score", self.score);
    visit("probability", self.probability);
    visit("visible_fraction", self.visible_fraction);
    visit("score_components", self.score_components);
    visit("alternatives", self.alternatives);
  }
};

struct Interpretation {
  static constexpr const char* kType = "bpa_msgs/msg/Interpretation";
  std::uint32_t rank = 0;
  double score = 0;
  double probability = 0;
  std::vector<Placement> placements;

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor&& visit) {
    visit("rank", self.rank);
    visit("score", self.score);
    visit("probability", self.probability);
    visit("placements", self.placements);
  }
};

struct StageTiming {
  static constexpr const char* kType = "bpa_msgs/msg/StageTiming";
  std::string name;
  double duration_ms = 0;

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor&& visit) {
    visit("name", self.name);
    visit("duration_ms", self.duration_ms);
  }
};

struct SceneInterpretations {
  static constexpr const char* kType = "bpa_msgs/msg/SceneInterpretations";
  std_msgs::Header header;
  Status status;
  std::vector<Interpretation> interpretations;
  std::vector<StageTiming> stage_timings;
  double total_ms = 0;
  bool budget_exhausted = false;
  std::uint32_t fused_frames = 0;
  std::uint32_t models_searched = 0;
  std::uint64_t seed = 0;

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor&& visit) {
    visit("header", self.header);
    visit("status", self.status);
    visit("interpretations", self.interpretations);
    visit("stage_timings", self.stage_timings);
    visit("total_ms", self.total_ms);
    visit("budget_exhausted", self.budget_exhausted);
    visit("fused_frames", self.fused_frames);
    visit("models_searched", self.models_searched);
    visit("seed", self.seed);
  }
};

struct ContinuousSymmetry {
  static constexpr const char* kType = "bpa_msgs/msg/ContinuousSymmetry";
  geometry_msgs::Vector3 axis;
  geometry_msgs::Point offset;

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor&& visit) {
    visit("axis", self.axis);
    visit("offset", self.offset);
  }
};

struct ModelInfo {
  static constexpr const char* kType = "bpa_msgs/msg/ModelInfo";
  std::string name;
  std::uint32_t number = 0;
  double diameter = 0;
  geometry_msgs::Point box_min;
  geometry_msgs::Point box_max;
  std::uint32_t point_count = 0;
  std::vector<geometry_msgs::Pose> discrete_symmetries;
  std::vector<ContinuousSymmetry> continuous_symmetries;

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor&& visit) {
    visit("name", self.name);
    visit("number", self.number);
    visit("diameter", self.diameter);
    visit("box_min", self.box_min);
    visit("box_max", self.box_max);
    visit("point_count", self.point_count);
    visit("discrete_symmetries", self.discrete_symmetries);
    visit("continuous_symmetries", self.continuous_symmetries);
  }
};

}  // namespace bpa::wire::bpa_msgs
