// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "server/recognition.hpp"
#include "tests/support/stub_tracker.hpp"

namespace bpa::support {

/// A fixed library without models whose detect() tests supply.
class StubRecognition : public server::Recognition {
 public:
  std::vector<std::uint8_t> annotate(const Frame& frame, const Interpretation&) const override {
    return std::vector<std::uint8_t>(3 * frame.depth.size(), 200);
  }
  std::unique_ptr<server::ObjectTracker> make_tracker(const track::TrackerOptions&) const override {
    return std::make_unique<StubTracker>();
  }
  std::string library() const override { return "stub"; }
  int version() const override { return 1; }
  Models models() const override { return {}; }
  std::vector<io::BrokenModel> broken() const override { return {}; }
  Result<std::shared_ptr<const ObjectModel>> load(const std::string&, const std::string&) override {
    return fixed();
  }
  Status unload(const std::string&) override { return fixed(); }
  Status set_options(const DetectorOptions&) override { return fixed(); }

 private:
  static Status fixed() {
    return Status(StatusCode::unsupported, "this library cannot be changed");
  }
};

}  // namespace bpa::support
