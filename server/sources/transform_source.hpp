// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "core/base/failure.hpp"
#include "idl/wire/messages.hpp"
#include "idl/wire/participant.hpp"
#include "idl/wire/subscriber.hpp"
#include "server/options.hpp"
#include "server/tf_buffer.hpp"

namespace bpa::server {

/// Takes the transforms of other participants from /tf and /tf_static. What this server publishes
/// there itself is ignored: it is about objects.
class TransformSource {
 public:
  /// `buffer` outlives it. An empty topic is left out. Throws a Failure.
  TransformSource(const wire::Participant& participant, const std::string& topic,
                  const std::string& static_topic, TfBuffer& buffer);

 private:
  void subscribe(const wire::Participant& participant, const std::string& topic,
                 const wire::Qos& qos, bool is_static, TfBuffer& buffer);

  std::vector<wire::Subscriber<wire::tf2_msgs::TFMessage>> subscribers_;
};

/// How many subscribers a TransformSource of this server has on output.tf: 1 where it takes the
/// camera's transforms from the same topic. Throws a Failure.
std::size_t own_transform_readers(const wire::Participant& participant,
                                  const ServerOptions& options);

}  // namespace bpa::server
