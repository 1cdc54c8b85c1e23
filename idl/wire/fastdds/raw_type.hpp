// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <utility>

#include <fastdds/dds/topic/TopicDataType.hpp>

#include "core/base/guarded.hpp"
#include "idl/wire/endpoint.hpp"
#include "idl/wire/fastdds/version.hpp"

// Private to idl/wire/fastdds, the only folder that includes Fast DDS.

namespace bpa::wire::detail {

/// What a reader's take_next_sample fills.
struct IncomingSample {
  const RawDecode* decode = nullptr;
  Status status;
  Deliver deliver;  ///< Empty when status is not ok.
};

/// A type that Fast DDS knows by its name only. Samples are MessageRef when written and
/// IncomingSample when taken, so that our own CDR code writes and reads the payload.
class RawType : public dds::TopicDataType {
 public:
  explicit RawType(const std::string& dds_type) {
#if BPA_FASTDDS_MAJOR >= 3
    set_name(dds_type);
    is_compute_key_provided = false;
    max_serialized_type_size = kFirstGuess;
#else
    setName(dds_type.c_str());
    m_isGetKeyDefined = false;
    m_typeSize = kFirstGuess;
    auto_fill_type_object(false);  // announcing nothing never refuses a peer
    auto_fill_type_information(false);
#endif
  }

#if BPA_FASTDDS_MAJOR >= 3
  bool serialize(const void* data, rtps::SerializedPayload_t& payload,
                 dds::DataRepresentationId_t) override {
    return write(data, payload);
  }
  bool deserialize(rtps::SerializedPayload_t& payload, void* data) override {
    return read(payload, data);
  }
  std::uint32_t calculate_serialized_size(const void* data, dds::DataRepresentationId_t) override {
    return size_of(data);
  }
  void* create_data() override { return nullptr; }
  void delete_data(void*) override {}
  bool compute_key(rtps::SerializedPayload_t&, rtps::InstanceHandle_t&, bool) override {
    return false;
  }
  bool compute_key(const void*, rtps::InstanceHandle_t&, bool) override { return false; }
#else
  bool serialize(void* data, rtps::SerializedPayload_t* payload) override {
    return write(data, *payload);
  }
  bool deserialize(rtps::SerializedPayload_t* payload, void* data) override {
    return read(*payload, data);
  }
  std::function<std::uint32_t()> getSerializedSizeProvider(void* data) override {
    return [data] { return size_of(data); };
  }
  void* createData() override { return nullptr; }
  void deleteData(void*) override {}
  bool getKey(void*, rtps::InstanceHandle_t*, bool) override { return false; }
#endif

 private:
  static constexpr std::uint32_t kFirstGuess = 1024;  ///< Bytes; samples grow from there.

  static bool write(const void* data, rtps::SerializedPayload_t& payload) {
    const auto& message = *static_cast<const MessageRef*>(data);
    const std::size_t size = message.encode(message.message, payload.data, payload.max_size);
    payload.length = static_cast<std::uint32_t>(size);
    payload.encapsulation = CDR_LE;
    return size != 0;
  }
  static bool read(const rtps::SerializedPayload_t& payload, void* data) {
    auto& sample = *static_cast<IncomingSample*>(data);
    // Fast DDS is not written for exceptions, and holds locks here.
    auto decoded = guarded("it cannot be decoded",
                           [&] { return (*sample.decode)(payload.data, payload.length); });
    sample.status = decoded.status();
    if (decoded.ok()) sample.deliver = std::move(decoded).value();
    return true;  // a malformed sample is taken as well, to be counted
  }
  static std::uint32_t size_of(const void* data) {
    const auto& message = *static_cast<const MessageRef*>(data);
    return static_cast<std::uint32_t>(message.encoded_size(message.message));
  }
};

}  // namespace bpa::wire::detail
