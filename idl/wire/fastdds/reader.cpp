// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <atomic>

#include <fastdds/dds/subscriber/DataReader.hpp>
#include <fastdds/dds/subscriber/DataReaderListener.hpp>
#include <fastdds/dds/subscriber/SampleInfo.hpp>

#include "idl/wire/fastdds/dds_qos.hpp"
#include "idl/wire/fastdds/participant_impl.hpp"
#include "idl/wire/fastdds/raw_type.hpp"

namespace bpa::wire::detail {

namespace {

SampleMeta to_meta(const dds::SampleInfo& info) {
  return {to_id(info.sample_identity), to_id(info.related_sample_identity),
          info.source_timestamp.to_ns()};
}

class Reader : public RawReader, private dds::DataReaderListener {
 public:
  Reader(const Participant& participant, EndpointSpec spec, RawDecode decode)
      : participant_(participant.impl()), spec_(std::move(spec)), decode_(std::move(decode)) {}

  Status open() {
    return participant_->open(spec_, true, [this](dds::Topic* topic) {
      dds::Subscriber& subscriber = *participant_->subscriber();
      reader_ = subscriber.create_datareader(topic, reader_qos(spec_, subscriber), this);
      if (reader_ != nullptr) guid_ = to_guid(reader_->guid());
      return guid_;
    });
  }

  ~Reader() override {
    if (reader_ == nullptr) return;
    {
      const std::lock_guard<std::mutex> lock(callback_mutex_);
      closed_ = true;
    }
    participant_->close(spec_, guid_, [this] {
      reader_->set_listener(nullptr);
      participant_->subscriber()->delete_datareader(reader_);
    });
  }

  Guid guid() const override { return guid_; }
  ReaderStatistics statistics() const override { return {received_, malformed_, lost_}; }

 private:
  // Samples come over UDP on one thread and through shared memory on another; one at a time.
  void on_data_available(dds::DataReader* reader) override {
    const std::lock_guard<std::mutex> lock(callback_mutex_);
    while (!closed_) {
      IncomingSample sample;
      sample.decode = &decode_;
      dds::SampleInfo info;
      if (!succeeded(reader->take_next_sample(&sample, &info))) return;
      if (!info.valid_data) continue;
      if (sample.deliver) {
        ++received_;
        sample.deliver(to_meta(info));
      } else {
        refuse(sample.status);
      }
    }
  }

  void refuse(const Status& status) {
    const std::uint64_t count = ++malformed_;
    if (!is_power_of_two(count)) return;  // a bad peer must not fill the log
    participant_->log(LogLevel::warning, "topic " + spec_.dds_topic + ": refused a sample (" +
                                             std::to_string(count) + " so far): " + status.message);
  }

  void on_subscription_matched(dds::DataReader*,
                               const dds::SubscriptionMatchedStatus& status) override {
    matches_.update(to_guid(status.last_publication_handle), status.current_count_change);
  }

  void on_requested_incompatible_qos(dds::DataReader*,
                                     const dds::RequestedIncompatibleQosStatus& status) override {
    participant_->log(LogLevel::warning,
                      incompatible_qos_text(spec_.dds_topic, false, status.last_policy_id));
  }

  void on_sample_lost(dds::DataReader*, const dds::SampleLostStatus& status) override {
    lost_ += static_cast<std::uint64_t>(std::max(status.total_count_change, 0));
  }

  void on_sample_rejected(dds::DataReader*, const SampleRejectedStatus& status) override {
    lost_ += status.total_count_change;
  }

  const std::shared_ptr<ParticipantImpl> participant_;
  const EndpointSpec spec_;
  const RawDecode decode_;
  Guid guid_{};
  std::atomic<std::uint64_t> received_{0}, malformed_{0}, lost_{0};
  std::mutex callback_mutex_;
  bool closed_ = false;
  dds::DataReader* reader_ = nullptr;
};

}  // namespace

Result<std::unique_ptr<RawReader>> make_reader(const Participant& participant, EndpointSpec spec,
                                               RawDecode decode) {
  auto reader = std::make_unique<Reader>(participant, std::move(spec), std::move(decode));
  Status status = reader->open();
  if (!status.ok()) return status;
  return std::unique_ptr<RawReader>(std::move(reader));
}

}  // namespace bpa::wire::detail
