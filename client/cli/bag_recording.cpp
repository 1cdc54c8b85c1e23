// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdio>
#include <iostream>
#include <iterator>
#include <memory>
#include <optional>
#include <set>
#include <utility>

#include "client/cli/commands.hpp"
#include "client/cli/inbox.hpp"
#include "client/src/join.hpp"
#include "core/base/concat.hpp"
#include "idl/wire/endpoint.hpp"
#include "idl/wire/message_definitions.hpp"
#include "ros/mcap_writer.hpp"

// record --bag. Messages are recorded as they lie on the wire. A topic's type is that of its
// publishers, so it is subscribed to once there is one.

namespace bpa::cli {
namespace {

using Clock = std::chrono::steady_clock;

/// What is recorded where nothing else is asked for.
const std::vector<std::string> kTopics = {
    "frames", "interpretations", "detections",    "markers", "vision_info",
    "tracks", "track_states",    "track_markers", "/tf",     "/tf_static"};
constexpr int kDepth = 100;  // messages of a topic that DDS keeps until they are taken
constexpr std::size_t kMostWaiting = 268'435'456;  // bytes; a disk may be slow for a moment
constexpr std::chrono::seconds kChunkTime(1);      // a crash costs no more

std::int64_t utc_ns() {
  return std::chrono::nanoseconds(std::chrono::system_clock::now().time_since_epoch()).count();
}

struct Arrival {
  std::uint16_t topic = 0;
  std::int64_t received_ns = 0, sent_ns = 0;
  std::vector<std::uint8_t> bytes;
};

class BagRecorder {
 public:
  BagRecorder(wire::Participant participant, const BagOptions& options)
      : participant_(std::move(participant)), named_(!options.topics.empty()) {
    for (const std::string& topic : named_ ? options.topics : kTopics) {
      missing_.insert(or_throw(participant_.resolve(topic)));
    }
    writer_.emplace(or_throw(ros::McapWriter::create(options.path)));
  }

  /// Subscribes to topics that are published by now, and writes what came.
  void step() {
    std::erase_if(missing_, [this](const std::string& topic) { return subscribe(topic); });
    write();
    if (Clock::now() < next_chunk_) return;
    or_throw(writer_->end_chunk());
    next_chunk_ = Clock::now() + kChunkTime;
  }

  void write() {
    for (const Arrival& arrival : arrivals_.take_all()) {
      const auto* cdr = reinterpret_cast<const char*>(arrival.bytes.data());
      waiting_ -= arrival.bytes.size();
      or_throw(writer_->add(arrival.topic, arrival.received_ns, arrival.sent_ns,
                            {cdr, arrival.bytes.size()}));
    }
  }

  /// Says which topics nobody publishes; of those that were not asked for, if that holds for all.
  void print_missing() const {
    if (missing_.empty() || !(named_ || readers_.empty())) return;
    std::cerr << "bpa-client: not published so far: " << listed(missing_) << '\n';
  }

  /// Completes the file.
  void finish(const std::string& path) {
    std::uint64_t lost = lost_;
    for (const auto& reader : readers_) lost += reader->statistics().lost;
    const std::size_t topics = readers_.size();
    readers_.clear();
    write();
    or_throw(writer_->finish());
    std::printf("%llu messages of %zu topics, %.1f MB in %s\n",
                static_cast<unsigned long long>(writer_->message_count()), topics,
                1e-6 * static_cast<double>(writer_->bytes()), path.c_str());
    if (lost > 0) {
      std::cerr << "bpa-client: " << lost << " messages were lost: the network or the disk is too "
                << "slow for these topics\n";
    }
  }

 private:
  /// False while nobody publishes the topic.
  bool subscribe(const std::string& topic) {
    auto spec = wire::detail::find_published(participant_, wire::dds_topic_name(topic));
    if (!spec) return false;
    const auto* type = std::ranges::find_if(wire::kMessageDefinitions, [&](const auto& one) {
      return wire::dds_type_name(one.name) == spec->dds_type;
    });
    if (type == std::end(wire::kMessageDefinitions)) {
      std::cerr << "bpa-client: " << topic << " is not recorded: bpa has no definition of its type "
                << spec->dds_type << '\n';
      return true;
    }
    const std::uint16_t number = writer_->add_topic(topic, *type, spec->qos);
    spec->user_data = concat("typehash=", type->hash, ";");
    spec->qos.depth = kDepth;
    auto take = [this, number](std::vector<std::uint8_t>&& bytes, const wire::SampleMeta& meta) {
      if (waiting_ + bytes.size() > kMostWaiting) {
        ++lost_;
        return;
      }
      waiting_ += bytes.size();
      const std::int64_t now = utc_ns();
      const std::int64_t sent = meta.source_time_ns > 0 ? meta.source_time_ns : now;
      arrivals_.add({number, now, sent, std::move(bytes)});
    };
    readers_.push_back(
        or_throw(wire::detail::make_reader(participant_, *spec, wire::detail::copy_bytes(take))));
    std::printf("recording %s (%s)\n", topic.c_str(), type->name);
    std::fflush(stdout);
    return true;
  }

  const wire::Participant participant_;
  const bool named_;
  std::set<std::string> missing_;
  std::optional<ros::McapWriter> writer_;
  Clock::time_point next_chunk_ = Clock::now() + kChunkTime;
  Inbox<Arrival> arrivals_;
  std::atomic<std::size_t> waiting_ = 0, lost_ = 0;                // bytes; messages
  std::vector<std::unique_ptr<wire::detail::RawReader>> readers_;  // last: they use the others
};

}  // namespace

void record_bag(const Common& common, const BagOptions& options) {
  BagRecorder recorder(or_throw(sdk::join(common.client_options())), options);
  const auto begun = Clock::now();
  bool waited = false;
  wait_until([&] {
    recorder.step();
    const std::chrono::duration<double> passed = Clock::now() - begun;
    if (!waited && passed.count() > common.timeout_s) {
      recorder.print_missing();
      waited = true;
    }
    return options.seconds > 0 && passed.count() >= options.seconds;
  });
  recorder.finish(options.path);
}

}  // namespace bpa::cli
