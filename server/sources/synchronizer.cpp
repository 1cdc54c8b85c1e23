// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "server/sources/synchronizer.hpp"

#include <algorithm>
#include <utility>

#include "idl/wire/time.hpp"

namespace bpa::server {
namespace {

/// A stream that goes back by more than this has started again (a bag played twice, say).
constexpr std::int64_t kRestartNs = 1'000'000'000;

std::int64_t gap(std::int64_t a, std::int64_t b) { return a < b ? b - a : a - b; }

}  // namespace

template <class T>
void Synchronizer::add(Stream<T>& stream, T&& message) {
  const std::int64_t stamp = to_ns(header_of(message).stamp);
  if (stream.newest_ns != INT64_MIN && stamp < stream.newest_ns - kRestartNs) {
    ++counts_.restarts;
    clear();
  }
  stream.newest_ns = std::max(stream.newest_ns, stamp);
  auto place = std::upper_bound(stream.items.begin(), stream.items.end(), stamp,
                                [](std::int64_t s, const auto& item) { return s < item.stamp_ns; });
  stream.items.insert(place, {stamp, std::make_shared<const T>(std::move(message))});
}

void Synchronizer::add_color(AnyImage&& image) {
  add(color_, std::move(image));
  while (color_.items.size() > options_.queue) {
    color_.items.pop_front();
    ++counts_.color_unused;
  }
}

void Synchronizer::add_depth(AnyImage&& image) {
  add(depth_, std::move(image));
  while (depth_.items.size() > options_.queue) {
    const std::int64_t stamp = depth_.items.front().stamp_ns;
    give_up_depth(choose(color_, stamp), choose(info_, stamp));
  }
}

void Synchronizer::add_info(wire::sensor_msgs::CameraInfo&& info) {
  add(info_, std::move(info));
  while (info_.items.size() > options_.queue) info_.items.pop_front();
}

template <class T>
Synchronizer::Choice Synchronizer::choose(const Stream<T>& stream, std::int64_t stamp_ns) const {
  Choice choice;
  choice.gap_ns = INT64_MAX;
  for (std::size_t i = 0; i < stream.items.size(); ++i) {
    const std::int64_t distance = gap(stream.items[i].stamp_ns, stamp_ns);
    if (distance < choice.gap_ns) {
      choice.index = i;
      choice.gap_ns = distance;
    }
  }
  const bool complete = choice.gap_ns == 0 || stream.newest_ns >= stamp_ns;
  if (choice.gap_ns <= options_.tolerance_ns && complete) {
    choice.kind = Choice::Kind::take;
  } else if (stream.newest_ns != INT64_MIN && stream.newest_ns > stamp_ns + options_.tolerance_ns) {
    choice.kind = Choice::Kind::none;
  }
  return choice;
}

std::optional<CameraImages> Synchronizer::next() {
  while (!depth_.items.empty()) {
    const std::int64_t stamp = depth_.items.front().stamp_ns;
    const Choice info = choose(info_, stamp);
    Choice color;
    color.kind = Choice::Kind::take;
    if (options_.with_color) color = choose(color_, stamp);
    if (color.kind == Choice::Kind::none || info.kind == Choice::Kind::none) {
      give_up_depth(color, info);
      continue;
    }
    if (color.kind == Choice::Kind::wait || info.kind == Choice::Kind::wait) return std::nullopt;
    return take(color, info);
  }
  return std::nullopt;
}

void Synchronizer::give_up_depth(const Choice& color, const Choice& info) {
  const bool no_color = options_.with_color && color.kind != Choice::Kind::take;
  const std::int64_t miss = no_color ? color.gap_ns : info.gap_ns;
  if (no_color) {
    ++counts_.depth_without_color;
  } else {
    ++counts_.depth_without_info;
  }
  if (miss != INT64_MAX && (counts_.nearest_miss_ns == 0 || miss < counts_.nearest_miss_ns)) {
    counts_.nearest_miss_ns = miss;
  }
  depth_.items.pop_front();
}

CameraImages Synchronizer::take(const Choice& color, const Choice& info) {
  CameraImages images;
  images.depth = std::move(depth_.items.front().message);
  depth_.items.pop_front();
  images.info = info_.items[info.index].message;
  const auto past_info = info_.items.begin() + static_cast<std::ptrdiff_t>(info.index) + 1;
  info_.items.erase(info_.items.begin(), past_info);
  if (options_.with_color) {
    images.color = std::move(color_.items[color.index].message);
    counts_.color_unused += color.index;
    const auto past_color = color_.items.begin() + static_cast<std::ptrdiff_t>(color.index) + 1;
    color_.items.erase(color_.items.begin(), past_color);
  }
  if (color.gap_ns == 0 && info.gap_ns == 0) {
    ++counts_.exact;
  } else {
    ++counts_.approximate;
  }
  return images;
}

void Synchronizer::clear() {
  color_ = {};
  depth_ = {};
  info_ = {};
}

}  // namespace bpa::server
