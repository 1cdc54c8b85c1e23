// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <atomic>
#include <cerrno>
#include <cstring>
#include <sstream>

#include <fastdds/dds/publisher/DataWriter.hpp>
#include <fastdds/dds/publisher/DataWriterListener.hpp>
#include <fastdds/dds/subscriber/DataReader.hpp>
#include <fastdds/dds/subscriber/DataReaderListener.hpp>
#include <fastdds/dds/subscriber/SampleInfo.hpp>
#include <sys/stat.h>
#include <sys/statvfs.h>
#include <unistd.h>

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

constexpr const char* kSharedMemory = "/dev/shm";

/// The kernel makes a file in memory whole only as it is filled, and kills the process that fills
/// it when no room is left (a container's /dev/shm has 64 MB unless told otherwise). So an endpoint
/// shares memory only if there is room for the most that it may come to fill.
void share_if_there_is_room(const ParticipantImpl& participant, std::uint64_t needed,
                            EndpointSpec& spec) {
  if (spec.shared_bytes == 0) return;
  struct statvfs shm = {};
  const bool usable = access(kSharedMemory, W_OK) == 0 && statvfs(kSharedMemory, &shm) == 0;
  const std::uint64_t room = usable ? std::uint64_t{shm.f_bavail} * shm.f_frsize : 0;
  if (needed <= room) return;
  participant.log(LogLevel::warning,
                  concat("topic ", spec.dds_topic, " goes over UDP: to share memory needs ",
                         needed >> 20U, " MB in /dev/shm, which has ", room >> 20U,
                         " MB free; enlarge it or allow less a frame"));
  spec.shared_bytes = 0;
}

std::uint64_t writer_memory(const EndpointSpec& spec) {
  return (static_cast<std::uint64_t>(std::max(spec.qos.depth, 1)) + 1) * spec.shared_bytes;
}

/// Of a reader: its notes of what has come, some 20 kB.
constexpr std::uint64_t kReaderMemory = 1U << 20U;

/// Fast DDS lets the whole machine read what an endpoint shares; only our user can make use of it.
void hide_shared_memory(const ParticipantImpl& participant, const EndpointSpec& spec,
                        const rtps::GUID_t& guid) {
  if (spec.shared_bytes == 0) return;
  std::ostringstream name;
  name << kSharedMemory << "/fast_datasharing_" << guid.guidPrefix << '_' << guid.entityId;
  if (chmod(name.str().c_str(), S_IRUSR | S_IWUSR) == 0) return;
  participant.log(LogLevel::warning,
                  concat(name.str(), " stays readable by other users: ", std::strerror(errno)));
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
      hide_shared_memory(*participant_, spec_, reader_->guid());
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
      hide_shared_memory(*participant_, spec_, writer_->guid());
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
    const std::size_t size = spec_.shared_bytes > 0 ? message.encoded_size(message.message) : 0;
    if (size > spec_.shared_bytes) {
      return invalid_argument("the message of ", size, " bytes on ", spec_.dds_topic,
                              " is larger than shared_bytes, which is ", spec_.shared_bytes);
    }
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
  share_if_there_is_room(*participant.impl(), kReaderMemory, spec);
  auto reader = std::make_unique<Reader>(participant, std::move(spec), std::move(decode));
  if (Status status = reader->open(); !status.ok()) return status;
  return std::unique_ptr<RawReader>(std::move(reader));
}

Result<std::unique_ptr<RawWriter>> make_raw_writer(std::shared_ptr<ParticipantImpl> participant,
                                                   EndpointSpec spec) {
  share_if_there_is_room(*participant, writer_memory(spec), spec);
  auto writer = std::make_unique<Writer>(std::move(participant), std::move(spec));
  if (Status status = writer->open(); !status.ok()) return status;
  return std::unique_ptr<RawWriter>(std::move(writer));
}

Result<std::unique_ptr<RawWriter>> make_writer(const Participant& participant, EndpointSpec spec) {
  return make_raw_writer(participant.impl(), std::move(spec));
}

}  // namespace bpa::wire::detail
