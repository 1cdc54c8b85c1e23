// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "server/sources/transform_source.hpp"

#include <utility>

namespace bpa::server {

TransformSource::TransformSource(const wire::Participant& participant, const std::string& topic,
                                 const std::string& static_topic, TfBuffer& buffer) {
  subscribe(participant, topic, wire::qos::transforms(), false, buffer);
  subscribe(participant, static_topic, wire::qos::static_transforms(), true, buffer);
}

void TransformSource::subscribe(const wire::Participant& participant, const std::string& topic,
                                const wire::Qos& qos, bool is_static, TfBuffer& buffer) {
  if (topic.empty()) return;
  using Message = wire::tf2_msgs::TFMessage;
  const wire::Guid own = wire::guid_of(participant);
  subscribers_.push_back(or_throw(wire::Subscriber<Message>::create(
      participant, topic, {.qos = qos},
      [&buffer, own, is_static](Message&& message, const wire::SampleMeta& meta) {
        if (wire::participant_of(meta.id.writer) == own) return;
        for (const auto& transform : message.transforms) buffer.add(transform, is_static);
      })));
}

std::size_t own_transform_readers(const wire::Participant& participant,
                                  const ServerOptions& options) {
  const std::string &out = options.output.tf, &in = options.input.tf;
  if (options.tracking.fixed_frame.empty() || out.empty() || in.empty()) return 0;
  return or_throw(participant.resolve(out)) == or_throw(participant.resolve(in)) ? 1 : 0;
}

}  // namespace bpa::server
