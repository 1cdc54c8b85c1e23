// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include <fastdds/dds/topic/TopicDataType.hpp>

#include <bpa/wire/endpoint.hpp>

// Private to idl/wire/fastdds, the only folder that includes Fast DDS.

namespace bpa::wire::detail {

/// What a reader's take_next_sample fills.
struct IncomingSample {
  const RawDecode* decode = nullptr;
  Status status;
  std::function<void(const SampleMeta&)> deliver;  ///< Empty when status is not ok.
};

/// A type that Fast DDS knows by its name only: samples are MessageRef when written and
/// IncomingSample when taken, so that our own CDR code writes into and reads from the payload.
class RawType : public eprosima::fastdds::dds::TopicDataType {
 public:
  explicit RawType(const std::string& dds_type);

  /// Before each endpoint of the type is made: > 0 makes it a bounded type of that size.
  void set_bound(std::size_t bytes);

  bool serialize(void* data, eprosima::fastrtps::rtps::SerializedPayload_t* payload) override;
  bool deserialize(eprosima::fastrtps::rtps::SerializedPayload_t* payload, void* data) override;
  std::function<std::uint32_t()> getSerializedSizeProvider(void* data) override;
  void* createData() override { return nullptr; }
  void deleteData(void*) override {}
  bool getKey(void*, eprosima::fastrtps::rtps::InstanceHandle_t*, bool) override { return false; }
  bool is_bounded() const override { return bounded_; }

 private:
  bool bounded_ = false;
};

}  // namespace bpa::wire::detail
