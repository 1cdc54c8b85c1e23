// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include <chrono>
#include <cstdio>

#include "server/sources/topic_source.hpp"

// What the topics have to report. That a camera is gone is told by its silence: publishers on
// Eclipse Cyclone DDS count as matched for seconds after they went.

namespace bpa::server {
namespace {

using Values = std::vector<wire::diagnostic_msgs::KeyValue>;

void add(Values& values, const std::string& key, std::uint64_t value) {
  values.push_back({key, std::to_string(value)});
}

std::string seconds(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.1f s", value);
  return text;
}

}  // namespace

std::optional<double> TopicSource::Topic::silence() const {
  if (last_ns == 0) return std::nullopt;
  const std::int64_t now_ns = std::chrono::steady_clock::now().time_since_epoch().count();
  return 1e-9 * static_cast<double>(now_ns - last_ns);
}

double TopicSource::longest_silence() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return options_.silence_s;
}

std::vector<SourceReport> TopicSource::reports() const {
  std::vector<SourceReport> reports;
  if (frames_.open()) reports.push_back(whole_report("frames", frames_));
  if (cloud_.open()) reports.push_back(whole_report("clouds", cloud_));
  if (depth_.open()) reports.push_back(camera_report());
  return reports;
}

SourceReport TopicSource::whole_report(const std::string& what, const Topic& topic) const {
  SourceReport report;
  report.name = what;
  report.hardware_id = topic.name;
  const std::size_t publishers = topic.publishers();
  const auto silence = topic.silence();
  if (!silence) {
    report.message = publishers > 0 ? "a publisher is there and has sent nothing yet" : "unused";
  } else if (*silence > longest_silence()) {
    report.level = SourceReport::kWarn;
    report.message = "nothing has come for " + seconds(*silence);
  } else {
    report.message = "they come";
  }
  const wire::ReaderStatistics statistics = topic.statistics();
  add(report.values, "publishers of " + what, publishers);
  add(report.values, "messages of " + what, statistics.received);
  add(report.values, "messages malformed of " + what, statistics.malformed);
  add(report.values, "messages lost by DDS of " + what, statistics.lost);
  return report;
}

/// What is wrong with the camera's topics, or an empty text.
std::string TopicSource::camera_trouble() const {
  const double limit = longest_silence();
  std::string trouble;
  bool alive = false, seen = false;
  const auto judge = [&](const char* what, const Topic& topic) {
    if (!topic.open()) return;
    const auto silence = topic.silence();
    seen = seen || silence;
    if (silence && *silence <= limit) {
      alive = true;
      return;
    }
    trouble += (trouble.empty() ? "no " : "; no ") + std::string(what) + " on " + topic.name +
               (silence ? " for " + seconds(*silence) : " so far") +
               (topic.publishers() == 0 ? ", nobody publishes it" : "");
  };
  judge("colour image", color_);
  judge("depth image", depth_);
  judge("camera info", info_);
  if (!seen) return "";
  return alive || trouble.empty() ? trouble : "the camera is gone: " + trouble;
}

SourceReport TopicSource::camera_report() const {
  SourceReport report;
  report.name = "camera";
  report.hardware_id = depth_.name;
  const std::string trouble = camera_trouble();
  if (!trouble.empty()) {
    report.level = SourceReport::kError;
    report.message = trouble;
  } else {
    report.message = depth_.silence() ? "images come" : "unused";
  }
  const SyncCounts sync = sync_counts();
  Values& values = report.values;
  add(values, "publishers of colour images", color_.open() ? color_.publishers() : 0);
  add(values, "publishers of depth images", depth_.publishers());
  add(values, "publishers of camera infos", info_.publishers());
  add(values, "camera sets with equal stamps", sync.exact);
  add(values, "camera sets with near stamps", sync.approximate);
  add(values, "depth images without a colour image", sync.depth_without_color);
  add(values, "depth images without a camera info", sync.depth_without_info);
  add(values, "colour images unused", sync.color_unused);
  add(values, "camera clock restarts", sync.restarts);
  wire::ReaderStatistics sum;
  for (const Topic* topic : {&color_, &depth_, &info_}) {
    if (!topic->open()) continue;
    const wire::ReaderStatistics one = topic->statistics();
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
