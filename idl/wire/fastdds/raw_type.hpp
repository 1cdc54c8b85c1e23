// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include <fastdds/dds/topic/TopicDataType.hpp>

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

/// A type that Fast DDS knows by its name only: samples are MessageRef when written and
/// IncomingSample when taken, so that our own CDR code writes into and reads from the payload.
class RawType : public dds::TopicDataType {
 public:
  explicit RawType(const std::string& dds_type);

  /// Before each endpoint of the type is made: > 0 makes it a bounded type of that size.
  void set_bound(std::size_t bytes);

#if BPA_FASTDDS_MAJOR >= 3
  bool serialize(const void* data, rtps::SerializedPayload_t& payload,
                 dds::DataRepresentationId_t representation) override;
  bool deserialize(rtps::SerializedPayload_t& payload, void* data) override;
  std::uint32_t calculate_serialized_size(const void* data,
                                          dds::DataRepresentationId_t representation) override;
  void* create_data() override { return nullptr; }
  void delete_data(void*) override {}
  bool compute_key(rtps::SerializedPayload_t&, rtps::InstanceHandle_t&, bool) override {
    return false;
  }
  bool compute_key(const void*, rtps::InstanceHandle_t&, bool) override { return false; }
#else
  bool serialize(void* data, rtps::SerializedPayload_t* payload) override;
  bool deserialize(rtps::SerializedPayload_t* payload, void* data) override;
  std::function<std::uint32_t()> getSerializedSizeProvider(void* data) override;
  void* createData() override { return nullptr; }
  void deleteData(void*) override {}
  bool getKey(void*, rtps::InstanceHandle_t*, bool) override { return false; }
#endif
  bool is_bounded() const override { return bounded_; }

 private:
  bool bounded_ = false;
};

}  // namespace bpa::wire::detail
