// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <atomic>

#include <fastdds/dds/publisher/DataWriter.hpp>
#include <fastdds/dds/publisher/DataWriterListener.hpp>
#include <fastdds/dds/subscriber/DataReader.hpp>
#include <fastdds/dds/subscriber/DataReaderListener.hpp>
#include <fastdds/dds/subscriber/SampleInfo.hpp>

#include "core/base/concat.hpp"
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
      if (reader_ == nullptr) return guid_;
      guid_ = to_guid(reader_->guid());
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
  ReaderStatistics statistics() const override {
    return {received_, malformed_, lost_, incompatible_};
  }

 private:
  // Each UDP port has a thread, and samples of one topic may come through several.
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
        sample.status = guarded("it cannot be taken", [&] { sample.deliver(to_meta(info)); });
      }
      if (!sample.status.ok()) refuse(sample.status, to_guid(info.sample_identity.writer_guid()));
    }
  }

  void refuse(const Status& status, const Guid& publisher) {
    ++malformed_;
    const std::uint64_t count = malformed_of_.add(publisher);
    if (count == 0) return;  // a bad peer must not fill the log
    participant_->log_peer(LogLevel::warning, publisher,
                           concat("topic ", spec_.dds_topic, ": refused a sample (", count,
                                  " of this publisher so far): ", status.message));
  }

  void on_subscription_matched(dds::DataReader*,
                               const dds::SubscriptionMatchedStatus& status) override {
    matches_.update(to_guid(status.last_publication_handle), status.current_count_change);
  }

  void on_requested_incompatible_qos(dds::DataReader*,
                                     const dds::RequestedIncompatibleQosStatus& status) override {
    incompatible_ += static_cast<std::uint64_t>(status.total_count_change);
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
  std::atomic<std::uint64_t> received_{0}, malformed_{0}, lost_{0}, incompatible_{0};
  PeerCounts malformed_of_;
  std::mutex callback_mutex_;
  bool closed_ = false;
  dds::DataReader* reader_ = nullptr;
};

class Writer : public RawWriter, private dds::DataWriterListener {
 public:
  Writer(std::shared_ptr<ParticipantImpl> participant, EndpointSpec spec)
      : participant_(std::move(participant)), spec_(std::move(spec)) {}

  Status open() {
    return participant_->open(spec_, false, [this](dds::Topic* topic) {
      dds::Publisher& publisher = *participant_->publisher();
      writer_ = publisher.create_datawriter(topic, writer_qos(spec_, publisher), this);
      if (writer_ == nullptr) return Guid{};
      return guid();
    });
  }

  ~Writer() override {
    if (writer_ == nullptr) return;
    participant_->close(spec_, guid(), [this] {
      writer_->set_listener(nullptr);
      participant_->publisher()->delete_datawriter(writer_);
    });
  }

  Status write(const MessageRef& message, const SampleId* related, SampleId* written) override {
    rtps::WriteParams params;
    if (related != nullptr) params.related_sample_identity(to_identity(*related));
    MessageRef data = message;
    if (!succeeded(writer_->write(&data, params))) {
      return Status(StatusCode::timeout,
                    "could not write to " + spec_.dds_topic +
                        ": the history is full, or the message breaks a bound");
    }
    if (written != nullptr) *written = to_id(params.sample_identity());
    return {};
  }

  void wait_until_received(std::chrono::milliseconds timeout) override {
    (void)writer_->wait_for_acknowledgments(to_duration(timeout.count()));
  }

  Guid guid() const override { return to_guid(writer_->guid()); }

 private:
  void on_publication_matched(dds::DataWriter*,
                              const dds::PublicationMatchedStatus& status) override {
    matches_.update(to_guid(status.last_subscription_handle), status.current_count_change);
  }

  void on_offered_incompatible_qos(dds::DataWriter*,
                                   const dds::OfferedIncompatibleQosStatus& status) override {
    participant_->log(LogLevel::warning,
                      incompatible_qos_text(spec_.dds_topic, true, status.last_policy_id));
  }

  const std::shared_ptr<ParticipantImpl> participant_;
  const EndpointSpec spec_;
  dds::DataWriter* writer_ = nullptr;
};

}  // namespace

Result<std::unique_ptr<RawReader>> make_reader(const Participant& participant, EndpointSpec spec,
                                               RawDecode decode) {
  auto reader = std::make_unique<Reader>(participant, std::move(spec), std::move(decode));
  if (Status status = reader->open(); !status.ok()) return status;
  return std::unique_ptr<RawReader>(std::move(reader));
}

Result<std::unique_ptr<RawWriter>> make_raw_writer(std::shared_ptr<ParticipantImpl> participant,
                                                   EndpointSpec spec) {
  auto writer = std::make_unique<Writer>(std::move(participant), std::move(spec));
  if (Status status = writer->open(); !status.ok()) return status;
  return std::unique_ptr<RawWriter>(std::move(writer));
}

Result<std::unique_ptr<RawWriter>> make_writer(const Participant& participant, EndpointSpec spec) {
  return make_raw_writer(participant.impl(), std::move(spec));
}

}  // namespace bpa::wire::detail
