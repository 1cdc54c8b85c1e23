// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include <bpa/wire/fastdds/raw_type.hpp>

namespace bpa::wire::detail {

using eprosima::fastrtps::rtps::SerializedPayload_t;

RawType::RawType(const std::string& dds_type) {
  setName(dds_type.c_str());
  m_isGetKeyDefined = false;
  auto_fill_type_object(false);  // announcing nothing never refuses a peer
  auto_fill_type_information(false);
  set_bound(0);
}

void RawType::set_bound(std::size_t bytes) {
  constexpr std::uint32_t kFirstGuess = 1024;
  bounded_ = bytes != 0;
  m_typeSize = bounded_ ? static_cast<std::uint32_t>(bytes) : kFirstGuess;
}

bool RawType::serialize(void* data, SerializedPayload_t* payload) {
  const auto& message = *static_cast<const MessageRef*>(data);
  const std::size_t size = message.encode(message.message, payload->data, payload->max_size);
  payload->length = static_cast<std::uint32_t>(size);
  payload->encapsulation = CDR_LE;
  return size != 0;
}

bool RawType::deserialize(SerializedPayload_t* payload, void* data) {
  auto& sample = *static_cast<IncomingSample*>(data);
  auto decoded = (*sample.decode)(payload->data, payload->length);
  sample.status = decoded.status();
  if (decoded.ok()) sample.deliver = std::move(decoded).value();
  return true;  // a malformed sample is taken as well, to be counted
}

std::function<std::uint32_t()> RawType::getSerializedSizeProvider(void* data) {
  const auto* message = static_cast<const MessageRef*>(data);
  return [message] { return static_cast<std::uint32_t>(message->encoded_size(message->message)); };
}

}  // namespace bpa::wire::detail
