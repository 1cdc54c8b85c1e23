// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include <cstdio>

#include "server/sources/topic_source.hpp"

// What the topics have to report. That a camera is gone is told by its silence: publishers on
// Eclipse Cyclone DDS count as matched for seconds after they went.

namespace bpa::server {
namespace {

using Values = std::vector<std::pair<std::string, std::string>>;

void add(Values& values, const std::string& key, std::uint64_t value) {
  values.emplace_back(key, std::to_string(value));
}

std::string seconds(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.1f s", value);
  return text;
}

}  // namespace

std::optional<double> TopicSource::Pulse::silence() const {
  const std::int64_t last = last_ns_;
  if (last == 0) return std::nullopt;
  return 1e-9 * static_cast<double>(now() - last);
}

double TopicSource::longest_silence() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return options_.silence_s;
}

std::vector<SourceReport> TopicSource::reports() const {
  std::vector<SourceReport> reports;
  if (frames_) {
    reports.push_back(whole_report("frames", frames_->topic(), frames_->matched_count(),
                                   frames_->statistics(), frames_pulse_));
  }
  if (cloud_) {
    reports.push_back(whole_report("clouds", cloud_->topic(), cloud_->matched_count(),
                                   cloud_->statistics(), cloud_pulse_));
  }
  if (depth_.open()) reports.push_back(camera_report());
  return reports;
}

SourceReport TopicSource::whole_report(const char* name, const std::string& topic,
                                       std::size_t publishers,
                                       const wire::ReaderStatistics& statistics,
                                       const Pulse& pulse) const {
  SourceReport report;
  report.name = name;
  report.hardware_id = topic;
  const auto silence = pulse.silence();
  if (!silence) {
    report.message = publishers > 0 ? "a publisher is there and has sent nothing yet" : "unused";
  } else if (*silence > longest_silence()) {
    report.level = SourceReport::Level::warning;
    report.message = "nothing has come for " + seconds(*silence);
  } else {
    report.message = "they come";
  }
  const std::string what = std::string(" of ") + name;
  add(report.values, "publishers" + what, publishers);
  add(report.values, "messages" + what, statistics.received);
  add(report.values, "messages malformed" + what, statistics.malformed);
  add(report.values, "messages lost by DDS" + what, statistics.lost);
  return report;
}

/// What is wrong with the camera's topics, or an empty text.
std::string TopicSource::camera_trouble() const {
  const double limit = longest_silence();
  std::string trouble;
  bool alive = false, seen = false;
  const auto judge = [&](const char* what, const std::string& topic, std::size_t publishers,
                         const Pulse& pulse) {
    const auto silence = pulse.silence();
    seen = seen || silence;
    if (silence && *silence <= limit) {
      alive = true;
      return;
    }
    trouble += (trouble.empty() ? "no " : "; no ") + std::string(what) + " on " + topic +
               (silence ? " for " + seconds(*silence) : " so far") +
               (publishers == 0 ? ", nobody publishes it" : "");
  };
  if (color_.open()) judge("colour image", color_.topic(), color_.publishers(), color_.pulse);
  judge("depth image", depth_.topic(), depth_.publishers(), depth_.pulse);
  judge("camera info", info_->topic(), info_->matched_count(), info_pulse_);
  if (!seen) return "";
  return alive || trouble.empty() ? trouble : "the camera is gone: " + trouble;
}

SourceReport TopicSource::camera_report() const {
  SourceReport report;
  report.name = "camera";
  report.hardware_id = depth_.topic();
  const std::string trouble = camera_trouble();
  if (!trouble.empty()) {
    report.level = SourceReport::Level::error;
    report.message = trouble;
  } else {
    report.message = depth_.pulse.silence() ? "images come" : "unused";
  }
  const SyncCounts sync = sync_counts();
  Values& values = report.values;
  add(values, "publishers of colour images", color_.publishers());
  add(values, "publishers of depth images", depth_.publishers());
  add(values, "publishers of camera infos", info_->matched_count());
  add(values, "camera sets with equal stamps", sync.exact);
  add(values, "camera sets with near stamps", sync.approximate);
  add(values, "depth images without a colour image", sync.depth_without_color);
  add(values, "depth images without a camera info", sync.depth_without_info);
  add(values, "colour images unused", sync.color_unused);
  add(values, "camera clock restarts", sync.restarts);
  wire::ReaderStatistics sum = color_.statistics();
  for (const auto& one : {depth_.statistics(), info_->statistics()}) {
    sum.received += one.received;
    sum.malformed += one.malformed;
    sum.lost += one.lost;
  }
  add(values, "messages of the camera", sum.received);
  add(values, "messages malformed of the camera", sum.malformed);
  add(values, "messages lost by DDS of the camera", sum.lost);
  return report;
}

}  // namespace bpa::server
