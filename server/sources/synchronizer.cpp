// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "server/sources/synchronizer.hpp"

#include <algorithm>
#include <cstdlib>
#include <utility>

#include "idl/wire/time.hpp"

namespace bpa::server {
namespace {

/// A stream that goes back by more than this has started again (a bag played twice, say).
constexpr std::int64_t kRestartNs = 1'000'000'000;

}  // namespace

template <class T>
void Synchronizer::add(Stream<T>& stream, T&& message) {
  const std::int64_t stamp = to_ns(header_of(message).stamp);
  if (stream.newest_ns != INT64_MIN && stamp < stream.newest_ns - kRestartNs) {
    ++counts_.restarts;
    color_ = {};
    depth_ = {};
    info_ = {};
  }
  stream.newest_ns = std::max(stream.newest_ns, stamp);
  const auto place = std::ranges::upper_bound(stream.items, stamp, {}, &Stream<T>::Item::stamp_ns);
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
  Choice choice{Choice::Kind::wait, 0, INT64_MAX};
  for (std::size_t i = 0; i < stream.items.size(); ++i) {
    const std::int64_t gap_ns = std::abs(stream.items[i].stamp_ns - stamp_ns);
    if (gap_ns < choice.gap_ns) choice = {Choice::Kind::wait, i, gap_ns};
  }
  const bool complete = choice.gap_ns == 0 || stream.newest_ns >= stamp_ns;
  if (choice.gap_ns <= options_.tolerance_ns && complete) {
    choice.kind = Choice::Kind::take;
  } else if (stream.newest_ns > stamp_ns + options_.tolerance_ns) {
    choice.kind = Choice::Kind::none;
  }
  return choice;
}

std::optional<CameraImages> Synchronizer::next() {
  while (!depth_.items.empty()) {
    const std::int64_t stamp = depth_.items.front().stamp_ns;
    const Choice info = choose(info_, stamp);
    const Choice color =
        options_.with_color ? choose(color_, stamp) : Choice{Choice::Kind::take, 0, 0};
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
  ++(no_color ? counts_.depth_without_color : counts_.depth_without_info);
  if (miss != INT64_MAX && (counts_.nearest_miss_ns == 0 || miss < counts_.nearest_miss_ns)) {
    counts_.nearest_miss_ns = miss;
  }
  depth_.items.pop_front();
}

template <class T>
std::shared_ptr<const T> Synchronizer::take(Stream<T>& stream, std::size_t index) {
  std::shared_ptr<const T> message = std::move(stream.items[index].message);
  const auto next = stream.items.begin() + static_cast<std::ptrdiff_t>(index) + 1;
  stream.items.erase(stream.items.begin(), next);
  return message;
}

CameraImages Synchronizer::take(const Choice& color, const Choice& info) {
  ++(color.gap_ns == 0 && info.gap_ns == 0 ? counts_.exact : counts_.approximate);
  CameraImages images;
  images.depth = take(depth_, 0);
  images.info = take(info_, info.index);
  if (options_.with_color) {
    counts_.color_unused += color.index;
    images.color = take(color_, color.index);
  }
  return images;
}

}  // namespace bpa::server
