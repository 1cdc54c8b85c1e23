// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include <fastdds/dds/publisher/DataWriter.hpp>
#include <fastdds/dds/publisher/DataWriterListener.hpp>
#include <sys/statvfs.h>

#include "idl/wire/fastdds/dds_qos.hpp"
#include "idl/wire/fastdds/participant_impl.hpp"

namespace bpa::wire::detail {

namespace {

/// The kernel makes a file in memory whole only as it is filled, and kills the process that fills
/// it when no room is left (a container's /dev/shm has 64 MB unless told otherwise). So a writer
/// shares memory only if there is room for the most that it may come to fill.
void share_what_there_is_room_for(const ParticipantImpl& participant, EndpointSpec& spec) {
  if (spec.shared_bytes == 0) return;
  struct statvfs shm = {};
  const std::uint64_t room =
      statvfs("/dev/shm", &shm) == 0 ? std::uint64_t{shm.f_bavail} * shm.f_frsize : 0;
  const auto samples = static_cast<std::uint64_t>(std::max(spec.qos.depth, 1)) + 1;
  const std::uint64_t needed = samples * spec.shared_bytes;
  if (needed <= room) return;
  participant.log(LogLevel::warning,
                  "topic " + spec.dds_topic + " goes over UDP: to share memory needs " +
                      std::to_string(needed >> 20U) + " MB in /dev/shm, which has " +
                      std::to_string(room >> 20U) + " MB free; enlarge it or allow less a frame");
  spec.shared_bytes = 0;
}

class Writer : public RawWriter, private dds::DataWriterListener {
 public:
  Writer(std::shared_ptr<ParticipantImpl> participant, EndpointSpec spec)
      : participant_(std::move(participant)), spec_(std::move(spec)) {}

  Status open() {
    return participant_->open(spec_, false, [this](dds::Topic* topic) {
      dds::Publisher& publisher = *participant_->publisher();
      writer_ = publisher.create_datawriter(topic, writer_qos(spec_, publisher), this);
      return writer_ == nullptr ? Guid{} : guid();
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
      return invalid_argument("the message of " + std::to_string(size) + " bytes on " +
                              spec_.dds_topic + " is larger than shared_bytes, which is " +
                              std::to_string(spec_.shared_bytes));
    }
    rtps::WriteParams params;
    if (related != nullptr) params.related_sample_identity(to_identity(*related));
    MessageRef data = message;
    if (!succeeded(writer_->write(&data, params))) {
      return Status(StatusCode::timeout,
                    "could not write to " + spec_.dds_topic +
                        ": the history is full, or the message breaks a bound");
    }
    if (written != nullptr) {
      *written = to_id(params.sample_identity());
    }
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

Result<std::unique_ptr<RawWriter>> make_raw_writer(std::shared_ptr<ParticipantImpl> participant,
                                                   EndpointSpec spec) {
  share_what_there_is_room_for(*participant, spec);
  auto writer = std::make_unique<Writer>(std::move(participant), std::move(spec));
  Status status = writer->open();
  if (!status.ok()) return status;
  return std::unique_ptr<RawWriter>(std::move(writer));
}

Result<std::unique_ptr<RawWriter>> make_writer(const Participant& participant, EndpointSpec spec) {
  return make_raw_writer(participant.impl(), std::move(spec));
}

}  // namespace bpa::wire::detail
