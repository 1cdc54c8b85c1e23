// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "ros/bag_frames.hpp"

#include <algorithm>
#include <map>
#include <utility>
#include <vector>

#include "core/base/concat.hpp"
#include "idl/wire/cdr.hpp"
#include "idl/wire/time.hpp"

namespace bpa::ros {
namespace {

using wire::bpa_msgs::RgbdFrame;
using wire::sensor_msgs::CameraInfo;
using wire::sensor_msgs::CompressedImage;
using wire::sensor_msgs::Image;
using wire::sensor_msgs::PointCloud2;
using wire::tf2_msgs::TFMessage;

/// A camera shows itself in this time, at any rate that is of use.
constexpr std::int64_t kFirstLook_ns = 3'000'000'000;

/// A topic that may make frames, by its first message.
struct Candidate {
  enum Kind { depth, color, info, cloud, frames } kind;
  std::string name;
  std::string frame_id;
  bool compressed = false;
  std::uint32_t width = 0, height = 0;  ///< Of raw images.
};
using Candidates = std::vector<Candidate>;

template <class Message>
bool is_of(const BagTopic& topic) {
  return topic.type == Message::kType;
}

template <class Message>
std::optional<Message> decode(const BagMessage& message) {
  Message decoded;
  const auto* bytes = reinterpret_cast<const std::uint8_t*>(message.bytes.data());
  if (!wire::decode(bytes, message.bytes.size(), decoded).ok()) return std::nullopt;
  return decoded;
}

std::optional<Candidate> candidate_of(const BagMessage& message) {
  const std::string& name = message.topic->name;
  if (is_of<RgbdFrame>(*message.topic)) return Candidate{Candidate::frames, name, ""};
  if (is_of<CameraInfo>(*message.topic)) return Candidate{Candidate::info, name, ""};
  if (is_of<PointCloud2>(*message.topic)) {
    const auto cloud = decode<PointCloud2>(message);
    if (!cloud || cloud->height < 2) return std::nullopt;
    return Candidate{Candidate::cloud, name, cloud->header.frame_id};
  }
  if (is_of<Image>(*message.topic)) {
    const auto image = decode<Image>(message);
    if (!image) return std::nullopt;
    const bool depth = image->encoding == "16UC1" || image->encoding == "32FC1";
    return Candidate{depth ? Candidate::depth : Candidate::color,
                     name,
                     image->header.frame_id,
                     false,
                     image->width,
                     image->height};
  }
  if (is_of<CompressedImage>(*message.topic)) {
    const auto image = decode<CompressedImage>(message);
    if (!image) return std::nullopt;
    const bool depth = image->format.find("compressedDepth") != std::string::npos ||
                       image->format.starts_with("16UC1");
    return Candidate{depth ? Candidate::depth : Candidate::color, name, image->header.frame_id,
                     true};
  }
  return std::nullopt;
}

std::string parent_of(const std::string& topic) { return topic.substr(0, topic.rfind('/')); }

/// The topic of images without image_transport's suffix.
std::string base_of(const Candidate& image) {
  return image.compressed ? parent_of(image.name) : image.name;
}

Candidates of_kind(const Candidates& all, Candidate::Kind kind) {
  Candidates some;
  for (const Candidate& one : all) {
    if (one.kind != kind) continue;
    const bool twice = one.compressed && std::ranges::any_of(all, [&](const Candidate& other) {
                         return !other.compressed && other.name == base_of(one);
                       });
    if (!twice) some.push_back(one);
  }
  return some;
}

std::string names_of(const Candidates& candidates) {
  std::vector<std::string> names;
  for (const Candidate& one : candidates) names.push_back(one.name);
  return listed(names);
}

/// Of several, those for which `better` holds, if it does for any.
template <class Better>
void prefer(Candidates& candidates, const Better& better) {
  if (std::ranges::any_of(candidates, better)) {
    std::erase_if(candidates, [&](const Candidate& one) { return !better(one); });
  }
}

/// Sets a topic that has no name yet to the only candidate.
Status choose(const Candidates& candidates, const char* what, std::string& name) {
  if (!name.empty() || candidates.empty()) return {};
  if (candidates.size() > 1) {
    return invalid_argument("several topics hold ", what, ": ", names_of(candidates),
                            "; name the one to read");
  }
  name = candidates.front().name;
  return {};
}

/// Completes the topics of depth images by those of the same camera.
Status choose_images(const Candidates& all, BagTopics& topics) {
  Candidates depths = of_kind(all, Candidate::depth);
  Candidates colors = of_kind(all, Candidate::color);
  // Registered depth is in the colour camera's frame.
  prefer(depths, [&](const Candidate& depth) {
    return std::ranges::any_of(colors, [&](const Candidate& color) {
      return color.frame_id == depth.frame_id && color.width == depth.width;
    });
  });
  if (Status status = choose(depths, "depth images", topics.depth); !status.ok()) return status;
  const auto depth = std::ranges::find(all, topics.depth, &Candidate::name);
  if (depth == all.end()) return not_found("no message of ", topics.depth, " in the first seconds");
  std::erase_if(colors, [&](const Candidate& color) { return color.frame_id != depth->frame_id; });
  prefer(colors, [&](const Candidate& color) {
    return color.width == depth->width &&
           named_rectified(color.name) == named_rectified(depth->name);
  });
  if (Status status = choose(colors, "colour images", topics.color); !status.ok()) return status;
  const auto color = std::ranges::find(all, topics.color, &Candidate::name);
  Candidates infos = of_kind(all, Candidate::info);
  for (const auto& image : {color, depth}) {
    if (image == all.end()) continue;
    const std::string beside = parent_of(base_of(*image)) + "/camera_info";
    prefer(infos, [&](const Candidate& info) { return info.name == beside; });
  }
  if (Status status = choose(infos, "camera infos", topics.camera_info); !status.ok())
    return status;
  if (topics.camera_info.empty()) return not_found("it has no camera info");
  return {};
}

/// Names all topics to read; whole frames take the place of clouds.
Status choose_topics(const Candidates& all, BagTopics& topics) {
  const bool named = !topics.depth.empty() || !topics.cloud.empty();
  const auto choose_kind = [&](Candidate::Kind kind, const char* what) {
    return choose(of_kind(all, kind), what, topics.cloud);
  };
  if (!named) {
    if (Status s = choose_kind(Candidate::frames, "whole frames"); !s.ok()) return s;
  }
  if (!topics.cloud.empty()) return {};
  if (named || !of_kind(all, Candidate::depth).empty()) return choose_images(all, topics);
  if (Status s = choose_kind(Candidate::cloud, "organised clouds"); !s.ok()) return s;
  if (!topics.cloud.empty()) return {};
  return not_found("it has neither depth images nor organised clouds in the first seconds");
}

}  // namespace

BagFrames::BagFrames(std::unique_ptr<BagReader> reader, BagTopics topics, double start_s,
                     OnTransforms on_transforms)
    : reader_(std::move(reader)),
      topics_(std::move(topics)),
      on_transforms_(std::move(on_transforms)),
      start_s_(start_s),
      synchronizer_({.with_color = !topics_.color.empty()}) {}

Result<BagFrames> BagFrames::open(const std::string& path, const BagTopics& topics, double start_s,
                                  OnTransforms on_transforms) {
  auto first_look = open_bag(path);
  if (!first_look.ok()) return first_look.status();
  std::map<std::string, std::optional<Candidate>> seen;
  std::string others;
  for (std::optional<std::int64_t> begin;;) {
    auto message = (*first_look)->next();
    if (!message.ok() && seen.empty()) return message.status();
    if (!message.ok() || !*message) break;
    if (!begin) begin = (*message)->time_ns;
    if ((*message)->time_ns - *begin > kFirstLook_ns) break;
    auto [place, is_new] = seen.try_emplace((*message)->topic->name);
    if (is_new) {
      others += concat(others.empty() ? "" : ", ", (*message)->topic->name, " (",
                       (*message)->topic->type, ")");
    }
    if (!place->second) place->second = candidate_of(**message);
  }
  Candidates candidates;
  for (auto& [name, candidate] : seen) {
    if (candidate) candidates.push_back(*std::move(candidate));
  }
  BagTopics chosen = topics;
  if (Status status = choose_topics(candidates, chosen); !status.ok()) {
    status.message = concat(path, ": ", status.message, ". Its topics: ", others);
    return status;
  }
  auto reader = open_bag(path);
  if (!reader.ok()) return reader.status();
  BagFrames bag(std::move(reader).value(), chosen, start_s, std::move(on_transforms));
  bag.rectified_ = named_rectified(chosen.color.empty() ? chosen.depth : chosen.color);
  if (!chosen.cloud.empty()) {
    bag.description_ = "frames of " + chosen.cloud;
  } else {
    bag.description_ =
        concat("depth of ", chosen.depth,
               chosen.color.empty() ? ", no colour" : ", colour of " + chosen.color, ", camera of ",
               chosen.camera_info, bag.rectified_ ? "; rectified, by their name" : "");
  }
  return bag;
}

template <class Message>
std::optional<Message> BagFrames::decoded(const BagMessage& message) {
  auto decoded = decode<Message>(message);
  if (!decoded) {
    ready_.emplace_back(RejectionCause::frame, corrupt("a message of ", message.topic->name, " (",
                                                       message.topic->type, ") is damaged"));
  }
  return decoded;
}

void BagFrames::take(const BagMessage& message) {
  const BagTopic& topic = *message.topic;
  const bool is_static = topic.name.ends_with("/tf_static");
  if (is_of<TFMessage>(topic)) {
    if (!on_transforms_ || (message.time_ns < start_ns_ && !is_static)) return;
    if (const auto transforms = decoded<TFMessage>(message)) on_transforms_(*transforms, is_static);
    return;
  }
  if (message.time_ns < start_ns_) return;
  if (topic.name == topics_.cloud) {
    if (is_of<RgbdFrame>(topic)) {
      if (auto frame = decoded<RgbdFrame>(message)) {
        ready_.push_back(frame_from_message(*std::move(frame)));
      }
    } else if (const auto cloud = decoded<PointCloud2>(message)) {
      ready_.push_back(frame_from_cloud(*cloud));
    }
    return;
  }
  const auto image = [&]() -> std::optional<AnyImage> {
    if (is_of<Image>(topic)) return decoded<Image>(message);
    return decoded<CompressedImage>(message);
  };
  if (topic.name == topics_.depth) {
    if (auto depth = image()) synchronizer_.add_depth(*std::move(depth));
  } else if (topic.name == topics_.color) {
    if (auto color = image()) synchronizer_.add_color(*std::move(color));
  } else if (topic.name == topics_.camera_info) {
    if (auto info = decoded<CameraInfo>(message)) synchronizer_.add_info(*std::move(info));
  }
  while (const auto images = synchronizer_.next()) {
    ready_.push_back(frame_from_images(*images, rectified_));
  }
}

Result<std::optional<DecodedFrame>> BagFrames::next() {
  while (ready_.empty()) {
    auto message = reader_->next();
    if (!message.ok()) return message.status();
    if (!*message) {
      if (any_frame_) return std::optional<DecodedFrame>();
      const SyncCounts counts = synchronizer_.counts();
      return not_found("it has no frame of ", description_, " after ", start_s_,
                       " s: ", counts.depth_without_color,
                       " depth images without a colour image and ", counts.depth_without_info,
                       " without a camera info within ", kSyncTolerance_ms, " ms");
    }
    if (start_ns_ == 0) start_ns_ = (*message)->time_ns + static_cast<std::int64_t>(start_s_ * 1e9);
    take(**message);
  }
  any_frame_ = true;
  std::optional<DecodedFrame> frame(std::move(ready_.front()));
  ready_.pop_front();
  return frame;
}

}  // namespace bpa::ros
