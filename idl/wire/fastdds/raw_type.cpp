// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "idl/wire/fastdds/raw_type.hpp"

namespace bpa::wire::detail {
namespace {

constexpr std::uint32_t kFirstGuess = 1024;

bool write_payload(const void* data, rtps::SerializedPayload_t& payload) {
  const auto& message = *static_cast<const MessageRef*>(data);
  const std::size_t size = message.encode(message.message, payload.data, payload.max_size);
  payload.length = static_cast<std::uint32_t>(size);
  payload.encapsulation = CDR_LE;
  return size != 0;
}

bool read_payload(const rtps::SerializedPayload_t& payload, void* data) {
  auto& sample = *static_cast<IncomingSample*>(data);
  auto decoded = (*sample.decode)(payload.data, payload.length);
  sample.status = decoded.status();
  if (decoded.ok()) sample.deliver = std::move(decoded).value();
  return true;  // a malformed sample is taken as well, to be counted
}

std::uint32_t size_of(const void* data) {
  const auto& message = *static_cast<const MessageRef*>(data);
  return static_cast<std::uint32_t>(message.encoded_size(message.message));
}

}  // namespace

#if BPA_FASTDDS_MAJOR >= 3

RawType::RawType(const std::string& dds_type) {
  set_name(dds_type);
  is_compute_key_provided = false;
  set_bound(0);
}

void RawType::set_bound(std::size_t bytes) {
  bounded_ = bytes != 0;
  max_serialized_type_size = bounded_ ? static_cast<std::uint32_t>(bytes) : kFirstGuess;
}

bool RawType::serialize(const void* data, rtps::SerializedPayload_t& payload,
                        dds::DataRepresentationId_t) {
  return write_payload(data, payload);
}

bool RawType::deserialize(rtps::SerializedPayload_t& payload, void* data) {
  return read_payload(payload, data);
}

std::uint32_t RawType::calculate_serialized_size(const void* data, dds::DataRepresentationId_t) {
  return size_of(data);
}

#else

RawType::RawType(const std::string& dds_type) {
  setName(dds_type.c_str());
  m_isGetKeyDefined = false;
  auto_fill_type_object(false);  // announcing nothing never refuses a peer
  auto_fill_type_information(false);
  set_bound(0);
}

void RawType::set_bound(std::size_t bytes) {
  bounded_ = bytes != 0;
  m_typeSize = bounded_ ? static_cast<std::uint32_t>(bytes) : kFirstGuess;
}

bool RawType::serialize(void* data, rtps::SerializedPayload_t* payload) {
  return write_payload(data, *payload);
}

bool RawType::deserialize(rtps::SerializedPayload_t* payload, void* data) {
  return read_payload(*payload, data);
}

std::function<std::uint32_t()> RawType::getSerializedSizeProvider(void* data) {
  return [data] { return size_of(data); };
}

#endif

}  // namespace bpa::wire::detail
