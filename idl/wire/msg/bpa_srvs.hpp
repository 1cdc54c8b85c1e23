// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "idl/wire/field.hpp"
#include "idl/wire/msg/bpa_msgs.hpp"
#include "idl/wire/msg/diagnostic_msgs.hpp"
// Our services. What the fields mean is said in idl/bpa_msgs/srv/*.srv.

namespace bpa::wire::bpa_msgs {

struct Detect_Request {
  static constexpr const char* kType = "bpa_msgs/srv/Detect_Request";
  bool has_frame = false;
  RgbdFrame frame;
  std::vector<std::string> models;
  std::uint32_t top_k = 0;
  double time_budget_ms = 0;
  double timeout_ms = 0;
  std::uint64_t seed = 0;

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor&& visit) {
    visit("has_frame", self.has_frame);
    visit("frame", self.frame);
    visit("models", self.models);
    visit("top_k", self.top_k);
    visit("time_budget_ms", self.time_budget_ms);
    visit("timeout_ms", self.timeout_ms);
    visit("seed", self.seed);
  }
};

struct Detect_Response {
  static constexpr const char* kType = "bpa_msgs/srv/Detect_Response";
  bool success = false;
  Status status;
  std::uint32_t queue_position = 0;
  SceneInterpretations result;

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor&& visit) {
    visit("success", self.success);
    visit("status", self.status);
    visit("queue_position", self.queue_position);
    visit("result", self.result);
  }
};

struct ListModels_Request {
  static constexpr const char* kType = "bpa_msgs/srv/ListModels_Request";
  std::vector<std::string> names;

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor&& visit) {
    visit("names", self.names);
  }
};

struct ListModels_Response {
  static constexpr const char* kType = "bpa_msgs/srv/ListModels_Response";
  bool success = false;
  Status status;
  std::string library;
  std::int32_t database_version = 0;
  std::vector<ModelInfo> models;

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor&& visit) {
    visit("success", self.success);
    visit("status", self.status);
    visit("library", self.library);
    visit("database_version", self.database_version);
    visit("models", self.models);
  }
};

struct LoadModel_Request {
  static constexpr const char* kType = "bpa_msgs/srv/LoadModel_Request";
  std::string source;
  std::string name;

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor&& visit) {
    visit("source", self.source);
    visit("name", self.name);
  }
};

struct LoadModel_Response {
  static constexpr const char* kType = "bpa_msgs/srv/LoadModel_Response";
  bool success = false;
  Status status;
  std::int32_t database_version = 0;
  ModelInfo model;

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor&& visit) {
    visit("success", self.success);
    visit("status", self.status);
    visit("database_version", self.database_version);
    visit("model", self.model);
  }
};

struct UnloadModel_Request {
  static constexpr const char* kType = "bpa_msgs/srv/UnloadModel_Request";
  std::string name;

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor&& visit) {
    visit("name", self.name);
  }
};

struct UnloadModel_Response {
  static constexpr const char* kType = "bpa_msgs/srv/UnloadModel_Response";
  bool success = false;
  Status status;
  std::int32_t database_version = 0;

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor&& visit) {
    visit("success", self.success);
    visit("status", self.status);
    visit("database_version", self.database_version);
  }
};

struct GetStatus_Request {
  static constexpr const char* kType = "bpa_msgs/srv/GetStatus_Request";
  std::uint8_t structure_needs_at_least_one_member = 0;

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor&& visit) {
    visit(kEmptyStructField, self.structure_needs_at_least_one_member);
  }
};

struct GetStatus_Response {
  static constexpr const char* kType = "bpa_msgs/srv/GetStatus_Response";
  static constexpr std::uint8_t kIdle = 0, kRunning = 1, kPaused = 2;
  bool success = false;
  Status status;
  std::string version;
  std::uint8_t state = 0;  ///< One of the constants.
  double uptime_s = 0;
  std::uint64_t frames_received = 0;
  std::uint64_t frames_processed = 0;
  std::uint64_t frames_dropped = 0;
  std::uint64_t frames_rejected = 0;
  std::uint64_t requests_served = 0;
  std::uint64_t requests_refused = 0;
  std::uint32_t queue_length = 0;
  std::uint32_t queue_capacity = 0;
  std::uint32_t model_count = 0;
  std::string library;
  std::int32_t database_version = 0;
  std::uint64_t memory_bytes = 0;
  std::vector<StageTiming> stage_timings;
  std::vector<diagnostic_msgs::KeyValue> details;

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor&& visit) {
    visit("success", self.success);
    visit("status", self.status);
    visit("version", self.version);
    visit("state", self.state);
    visit("uptime_s", self.uptime_s);
    visit("frames_received", self.frames_received);
    visit("frames_processed", self.frames_processed);
    visit("frames_dropped", self.frames_dropped);
    visit("frames_rejected", self.frames_rejected);
    visit("requests_served", self.requests_served);
    visit("requests_refused", self.requests_refused);
    visit("queue_length", self.queue_length);
    visit("queue_capacity", self.queue_capacity);
    visit("model_count", self.model_count);
    visit("library", self.library);
    visit("database_version", self.database_version);
    visit("memory_bytes", self.memory_bytes);
    visit("stage_timings", self.stage_timings);
    visit("details", self.details);
  }
};

struct Record_Request {
  static constexpr const char* kType = "bpa_msgs/srv/Record_Request";
  std::string path;
  double seconds = 0;
  bool stop = false;

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor&& visit) {
    visit("path", self.path);
    visit("seconds", self.seconds);
    visit("stop", self.stop);
  }
};

struct Record_Response {
  static constexpr const char* kType = "bpa_msgs/srv/Record_Response";
  bool success = false;
  Status status;
  std::string path;
  std::uint32_t frames = 0;
  std::uint64_t bytes = 0;

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor&& visit) {
    visit("success", self.success);
    visit("status", self.status);
    visit("path", self.path);
    visit("frames", self.frames);
    visit("bytes", self.bytes);
  }
};

struct Detect {
  using Request = Detect_Request;
  using Response = Detect_Response;
};

struct ListModels {
  using Request = ListModels_Request;
  using Response = ListModels_Response;
};

struct LoadModel {
  using Request = LoadModel_Request;
  using Response = LoadModel_Response;
};

struct UnloadModel {
  using Request = UnloadModel_Request;
  using Response = UnloadModel_Response;
};

struct Record {
  using Request = Record_Request;
  using Response = Record_Response;
};

struct GetStatus {
  using Request = GetStatus_Request;
  using Response = GetStatus_Response;
};

}  // namespace bpa::wire::bpa_msgs
