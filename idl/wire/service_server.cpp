// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include <atomic>
#include <mutex>

#include <bpa/wire/service.hpp>
#include <bpa/wire/service_framing.hpp>
#include <bpa/wire/worker.hpp>

namespace bpa::wire::detail {
namespace {

using Clock = Worker::Clock;
using std::chrono::milliseconds;

/// A reply waits so long for its client's reader to be matched.
constexpr milliseconds kClientPatience{2000};
constexpr milliseconds kRetryPeriod{5};
/// A reader of Eclipse Cyclone starts behind what the first heartbeat after matching covers, so a
/// reply sent sooner than the second one may be lost.
constexpr milliseconds kCycloneGrace{200};
constexpr int kMaxWaitingReplies = 256;

}  // namespace

class ServiceServerImpl : public std::enable_shared_from_this<ServiceServerImpl> {
 public:
  ServiceServerImpl(const Participant& participant, std::string name, RequestDecode decode)
      : participant_(participant), name_(std::move(name)), decode_(std::move(decode)) {}

  Status open(EndpointSpec request, EndpointSpec reply) {
    auto writer = make_writer(participant_, std::move(reply));
    if (!writer.ok()) return writer.status();
    replies_ = std::move(writer).value();
    // The bytes are copied out: whose request it is, is known only once the sample has been taken.
    const std::weak_ptr<ServiceServerImpl> weak = weak_from_this();
    auto take = [weak](const std::uint8_t* bytes,
                       std::size_t size) -> Result<std::function<void(const SampleMeta&)>> {
      auto copy = std::make_shared<std::vector<std::uint8_t>>(bytes, bytes + size);
      return std::function<void(const SampleMeta&)>([weak, copy](const SampleMeta& meta) {
        if (const auto self = weak.lock()) self->on_request(*copy, meta);
      });
    };
    auto reader = make_reader(participant_, std::move(request), std::move(take));
    if (!reader.ok()) return reader.status();
    requests_ = std::move(reader).value();
    return {};
  }

  void stop() {
    requests_.reset();  // no handler runs after this
    std::shared_ptr<RawWriter> last;
    const std::lock_guard<std::mutex> lock(mutex_);
    last.swap(replies_);
  }

  ReaderStatistics statistics() const {
    ReaderStatistics result;
    result.received = received_;
    result.malformed = malformed_;
    if (requests_) result.lost = requests_->statistics().lost;
    return result;
  }

  Status send(const ReplyAddress& address, const MessageRef& response) {
    std::vector<std::uint8_t> bytes = frame_reply(address, response);
    if (bytes.empty())
      return invalid_argument("the reply of " + name_ + " breaks one of its bounds");
    if (waiting_ >= kMaxWaitingReplies) {
      return Status(StatusCode::busy, "too many replies of " + name_ + " wait for their clients");
    }
    return try_send(address, std::move(bytes), Clock::now() + kClientPatience);
  }

 private:
  void on_request(const std::vector<std::uint8_t>& bytes, const SampleMeta& meta);

  Status try_send(const ReplyAddress& address, std::vector<std::uint8_t> bytes,
                  Clock::time_point deadline) {
    std::shared_ptr<RawWriter> writer;
    {
      const std::lock_guard<std::mutex> lock(mutex_);
      writer = replies_;
    }
    if (!writer) return Status(StatusCode::unavailable, "the service " + name_ + " has ended");
    const auto matched = writer->matched_for(address.reader);
    const milliseconds grace =
        address.framing == Framing::cyclone ? kCycloneGrace : milliseconds{0};
    if (matched && *matched >= grace) {
      const bool beside = address.framing == Framing::fastdds;
      return writer->write(bytes_ref(bytes), beside ? &address.related : nullptr, nullptr);
    }
    if (Clock::now() > deadline) {
      log(participant_log(participant_), LogLevel::info,
          name_ + ": dropped a reply, its client does not listen any more");
      return {};
    }
    ++waiting_;
    const std::weak_ptr<ServiceServerImpl> weak = weak_from_this();
    participant_worker(participant_)
        .run_at(Clock::now() + kRetryPeriod,
                [weak, address, deadline,
                 shared = std::make_shared<std::vector<std::uint8_t>>(std::move(bytes))] {
                  const auto self = weak.lock();
                  if (!self) return;
                  --self->waiting_;
                  const Status status = self->try_send(address, std::move(*shared), deadline);
                  if (!status.ok())
                    log(participant_log(self->participant_), LogLevel::warning, status.message);
                });
    return {};
  }

  const Participant participant_;
  const std::string name_;
  const RequestDecode decode_;
  std::unique_ptr<RawReader> requests_;
  std::mutex mutex_;
  std::shared_ptr<RawWriter> replies_;
  std::atomic<int> waiting_{0};
  std::atomic<std::uint64_t> received_{0}, malformed_{0};
};

namespace {

class Pending : public PendingReply {
 public:
  Pending(std::weak_ptr<ServiceServerImpl> server, const ReplyAddress& address)
      : server_(std::move(server)), address_(address) {}

  Status reply(const MessageRef& response) override {
    if (answered_.exchange(true)) return invalid_argument("this request has been answered already");
    const auto server = server_.lock();
    if (!server) return Status(StatusCode::unavailable, "the service has ended");
    return server->send(address_, response);
  }

 private:
  const std::weak_ptr<ServiceServerImpl> server_;
  const ReplyAddress address_;
  std::atomic<bool> answered_{false};
};

}  // namespace

void ServiceServerImpl::on_request(const std::vector<std::uint8_t>& bytes, const SampleMeta& meta) {
  ReplyAddress address;
  std::size_t offset = 0;
  bool swap = false;
  Status status = read_request_frame(bytes, meta, &address, &offset, &swap);
  if (status.ok()) {
    CdrReader reader(bytes.data() + offset, bytes.size() - offset, swap);
    auto handle = decode_(reader);
    if (handle.ok()) {
      ++received_;
      (*handle)(std::make_shared<Pending>(weak_from_this(), address));
      return;
    }
    status = handle.status();
  }
  ++malformed_;
  log(participant_log(participant_), LogLevel::warning,
      name_ + ": refused a request: " + status.message);
}

Result<std::shared_ptr<ServiceServerImpl>> make_server(const Participant& participant,
                                                       EndpointSpec request, EndpointSpec reply,
                                                       RequestDecode decode) {
  auto server =
      std::make_shared<ServiceServerImpl>(participant, request.dds_topic, std::move(decode));
  Status status = server->open(std::move(request), std::move(reply));
  if (!status.ok()) return status;
  return server;
}

ReaderStatistics server_statistics(const ServiceServerImpl& server) { return server.statistics(); }

void stop_server(ServiceServerImpl& server) { server.stop(); }

}  // namespace bpa::wire::detail
