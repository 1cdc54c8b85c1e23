// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include <atomic>
#include <map>
#include <mutex>

#include "idl/wire/service.hpp"
#include "idl/wire/service_framing.hpp"
#include "idl/wire/worker.hpp"

namespace bpa::wire::detail {
namespace {

using Clock = Worker::Clock;
using std::chrono::milliseconds;

/// A reply waits so long for its client's reader to be matched.
constexpr milliseconds kClientPatience{2000};
constexpr milliseconds kRetryPeriod{5};
constexpr milliseconds kRepeatAfter[] = {milliseconds{200}, milliseconds{600}};
constexpr int kMaxWaitingReplies = 256;  ///< Of which a client that does not listen has
constexpr int kMaxWaitingOfClient = 32;  ///< no more than these.
constexpr std::size_t kMaxGreeted = 1024;
constexpr int kMaxRepeated = 16;  ///< Replies to one new client that go out again.

struct Reply {
  ReplyAddress address;
  std::vector<std::uint8_t> bytes;
  Clock::time_point deadline;
};
using ReplyPtr = std::shared_ptr<const Reply>;

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
    // The reader is a member: while it calls back, this exists.
    auto take = [this](const std::uint8_t* bytes,
                       std::size_t size) -> Result<std::function<void(const SampleMeta&)>> {
      auto copy = std::make_shared<std::vector<std::uint8_t>>(bytes, bytes + size);
      return std::function<void(const SampleMeta&)>(
          [this, copy](const SampleMeta& meta) { on_request(*copy, meta); });
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
    auto reply = std::make_shared<Reply>();
    reply->address = address;
    reply->bytes = frame_reply(address, response);
    reply->deadline = Clock::now() + kClientPatience;
    if (reply->bytes.empty()) {
      return invalid_argument("the reply of " + name_ + " breaks one of its bounds");
    }
    if (!start_waiting(*reply)) {
      return Status(StatusCode::busy, "too many replies of " + name_ + " wait for their clients");
    }
    return send_when_matched(std::move(reply));
  }

 private:
  void on_request(const std::vector<std::uint8_t>& bytes, const SampleMeta& meta);

  std::shared_ptr<RawWriter> writer() {
    const std::lock_guard<std::mutex> lock(mutex_);
    return replies_;
  }

  Status send_when_matched(ReplyPtr reply) {
    const auto to = writer();
    if (!to) {
      stop_waiting(*reply);
      return Status(StatusCode::unavailable, "the service " + name_ + " has ended");
    }
    if (!to->is_matched_with(reply->address.reader)) {
      if (Clock::now() > reply->deadline) {
        stop_waiting(*reply);
        log(participant_log(participant_), LogLevel::info,
            name_ + ": dropped a reply, its client does not listen any more");
      } else {
        run_after(kRetryPeriod, [reply = std::move(reply)](ServiceServerImpl& self) {
          self.warn(self.send_when_matched(reply));
        });
      }
      return {};
    }
    stop_waiting(*reply);
    Status status = write(*to, *reply);
    if (reply->address.framing == Framing::cyclone) repeat_if_new(reply);
    return status;
  }

  /// Whether there is room for one more reply whose client may not be matched yet.
  bool start_waiting(const Reply& reply) {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (waiting_ >= kMaxWaitingReplies) return false;
    int& of_client = waiting_of_[reply.address.client];
    if (of_client >= kMaxWaitingOfClient) return false;
    ++of_client;
    ++waiting_;
    return true;
  }
  void stop_waiting(const Reply& reply) {
    const std::lock_guard<std::mutex> lock(mutex_);
    --waiting_;
    const auto of_client = waiting_of_.find(reply.address.client);
    if (--of_client->second == 0) waiting_of_.erase(of_client);
  }

  /// A reader of Eclipse Cyclone starts after what the first heartbeat that it sees covers, so the
  /// first replies may have been lost on it; two heartbeats later they go out again, and once more.
  /// A client ignores what it has got already.
  void repeat_if_new(const ReplyPtr& reply) {
    {
      const std::lock_guard<std::mutex> lock(mutex_);
      if (greeted_.size() >= kMaxGreeted) greeted_.clear();
      Greeting& greeting = greeted_[reply->address.reader];
      if (greeting.repeated == 0) greeting.since = Clock::now();
      const bool is_new = Clock::now() - greeting.since < kRepeatAfter[0];
      if (!is_new || greeting.repeated >= kMaxRepeated) return;
      ++greeting.repeated;
    }
    for (const milliseconds after : kRepeatAfter) {
      run_after(after, [reply](ServiceServerImpl& self) {
        const auto to = self.writer();
        if (to) self.warn(write(*to, *reply));
      });
    }
  }

  static Status write(RawWriter& writer, const Reply& reply) {
    const bool beside = reply.address.framing == Framing::fastdds;
    return writer.write(bytes_ref(reply.bytes), beside ? &reply.address.related : nullptr, nullptr);
  }

  /// Runs it later on the worker, if the server still exists.
  void run_after(milliseconds time, std::function<void(ServiceServerImpl&)> task) {
    participant_worker(participant_)
        .run_at(Clock::now() + time, [weak = weak_from_this(), task = std::move(task)] {
          if (const auto self = weak.lock()) task(*self);
        });
  }

  void warn(const Status& status) {
    if (!status.ok()) log(participant_log(participant_), LogLevel::warning, status.message);
  }

  const Participant participant_;
  const std::string name_;
  const RequestDecode decode_;
  std::unique_ptr<RawReader> requests_;
  std::mutex mutex_;
  std::shared_ptr<RawWriter> replies_;
  struct Greeting {
    Clock::time_point since;  ///< Of the first reply.
    int repeated = 0;
  };
  std::map<Guid, Greeting> greeted_;  ///< Clients on Cyclone that have been answered.
  std::map<Guid, int> waiting_of_;    ///< By client: replies that are not sent yet.
  int waiting_ = 0;                   ///< All of them.
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
  Guid client() const override { return address_.client; }

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
  const std::uint64_t count = ++malformed_;
  if (!is_power_of_two(count)) return;
  log(participant_log(participant_), LogLevel::warning,
      name_ + ": refused a request (" + std::to_string(count) + " so far): " + status.message);
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
