// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <atomic>
#include <cstring>
#include <map>
#include <mutex>

#include "core/base/concat.hpp"
#include "core/base/guarded.hpp"
#include "idl/wire/private/service_framing.hpp"
#include "idl/wire/service.hpp"
#include "idl/wire/task_thread.hpp"

namespace bpa::wire::detail {
namespace {

using Clock = TaskThread::Clock;
using std::chrono::milliseconds;
using Bytes = std::vector<std::uint8_t>;

/// A reply waits so long for its client's reader to be matched.
constexpr milliseconds kClientPatience{2000};
constexpr milliseconds kRetryPeriod{5};
/// A server that leaves waits so long until clients have its replies.
constexpr milliseconds kLastReplies{500};
constexpr milliseconds kRepeatAfter[] = {milliseconds{200}, milliseconds{600}};
constexpr int kMaxWaitingReplies = 256;  ///< Of which a client that does not listen has
constexpr int kMaxWaitingOfClient = 32;  ///< no more than these.
constexpr std::size_t kMaxGreeted = 1024;
constexpr int kMaxRepeated = 16;  ///< Replies to one new client that go out again.

bool is_reader(const Guid& guid) {
  const int kind = guid[15] & 0x3f;  // with a key 0x07, without 0x04
  return kind == 0x04 || kind == 0x07;
}

struct Reply {
  ReplyAddress address;
  Bytes bytes;
  Clock::time_point deadline;
};
using ReplyPtr = std::shared_ptr<const Reply>;

class Server : public RawServer, public std::enable_shared_from_this<Server> {
 public:
  Server(const Participant& participant, std::string name, std::size_t max_request,
         RequestDecode decode)
      : participant_(participant),
        name_(std::move(name)),
        max_request_(max_request),
        decode_(std::move(decode)) {}

  Status open(const ServiceSpec& spec) {
    auto writer = make_writer(participant_, spec.reply);
    if (!writer.ok()) return writer.status();
    replies_ = std::move(writer).value();
    // Copied out: whose request it is, is known only once the sample has been taken.
    // The reader is a member: while it calls back, this exists.
    auto take =
        copy_bytes([this](Bytes&& bytes, const SampleMeta& meta) { on_request(bytes, meta); });
    auto reader = make_reader(participant_, spec.request, std::move(take));
    if (!reader.ok()) return reader.status();
    requests_ = std::move(reader).value();
    return {};
  }

  void stop() {
    // Clients give up once they know that the server has left; what was answered comes before.
    writer()->wait_until_received(kLastReplies);
    requests_.reset();  // no handler runs after this
    std::shared_ptr<RawWriter> last;
    const std::lock_guard<std::mutex> lock(mutex_);
    last.swap(replies_);
  }

  ServiceStatistics statistics() const override {
    return {received_, malformed_, requests_ ? requests_->statistics().lost : 0, replies_dropped_};
  }

  Status send(const ReplyAddress& address, const MessageRef& response) {
    const auto reply = std::make_shared<const Reply>(
        Reply{address, frame_reply(address, response), Clock::now() + kClientPatience});
    if (reply->bytes.empty()) {
      ++replies_dropped_;
      return invalid_argument("the reply of " + name_ + " breaks one of its bounds");
    }
    if (!start_waiting(*reply)) {
      ++replies_dropped_;
      return Status(StatusCode::busy, "too many replies of " + name_ + " wait for their clients");
    }
    return send_when_matched(reply);
  }

 private:
  void on_request(const Bytes& bytes, const SampleMeta& meta) {
    ReplyAddress address;
    std::size_t offset = 0;
    bool swap = false;
    Status status = read_request_frame(bytes, meta, &address, &offset, &swap);
    if (bytes.size() > max_request_) {
      status = invalid_argument("it has " + std::to_string(bytes.size()) + " bytes; at most " +
                                std::to_string(max_request_) + " are read");
    }
    if (status.ok()) {
      CdrReader reader(bytes.data() + offset, bytes.size() - offset, swap);
      auto handle = decode_(reader);
      if (handle.ok()) {
        ++received_;
        (*handle)(pending_reply(address));
        return;
      }
      status = handle.status();
    }
    ++malformed_;
    const std::uint64_t count = malformed_of_.add(meta.id.writer);
    if (count == 0) return;
    log(log_of(meta.id.writer), LogLevel::warning,
        concat(name_, ": refused a request (", count, " of this client so far): ", status.message));
  }

  std::shared_ptr<PendingReply> pending_reply(const ReplyAddress& address) {
    auto pending = std::make_shared<PendingReply>();
    pending->client = address.client;
    pending->send = [weak = weak_from_this(), address](const MessageRef& response) {
      const auto self = weak.lock();
      if (!self) return Status(StatusCode::unavailable, "the service has ended");
      return guarded("the reply cannot be sent", [&] { return self->send(address, response); });
    };
    return pending;
  }

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
    if (!to->matches().contains(reply->address.reader)) {
      if (Clock::now() > reply->deadline) {
        stop_waiting(*reply);
        ++replies_dropped_;
        log(log_of(reply->address.client), LogLevel::info,
            name_ + ": dropped a reply, its client does not listen any more");
      } else {
        run_after(kRetryPeriod, [reply = std::move(reply)](Server& self) {
          self.warn(self.send_when_matched(reply));
        });
      }
      return {};
    }
    stop_waiting(*reply);
    Status status = write(*to, *reply);
    if (!status.ok()) ++replies_dropped_;
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
      run_after(after, [reply](Server& self) {
        const auto to = self.writer();
        if (to) self.warn(write(*to, *reply));
      });
    }
  }

  static Status write(RawWriter& writer, const Reply& reply) {
    const bool beside = reply.address.framing == Framing::fastdds;
    return writer.write(bytes_ref(reply.bytes), beside ? &reply.address.related : nullptr, nullptr);
  }

  /// Runs it later on the task thread, if the server still exists.
  void run_after(milliseconds time, std::function<void(Server&)> task) {
    participant_tasks(participant_)
        .run_at(Clock::now() + time, [weak = weak_from_this(), task = std::move(task)] {
          if (const auto self = weak.lock()) task(*self);
        });
  }

  LogHook log_of(const Guid& client) const {
    return hook_of_peer(participant_log(participant_), to_text(client));
  }

  void warn(const Status& status) {
    if (!status.ok()) log(participant_log(participant_), LogLevel::warning, status.message);
  }

  const Participant participant_;
  const std::string name_;
  const std::size_t max_request_;
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
  std::atomic<std::uint64_t> received_{0}, malformed_{0}, replies_dropped_{0};
  PeerCounts malformed_of_;
};

}  // namespace

Status read_request_frame(const std::vector<std::uint8_t>& bytes, const SampleMeta& meta,
                          ReplyAddress* address, std::size_t* body_offset, bool* swap) {
  if (!read_cdr_header(bytes.data(), bytes.size(), swap)) {
    return Status(StatusCode::corrupt, "not plain CDR");
  }
  address->client = participant_of(meta.id.writer);
  if (meta.related.writer != Guid{}) {
    const Guid& client = meta.related.writer;
    address->framing = Framing::fastdds;
    address->related = {client, meta.id.sequence};
    address->reader = is_reader(client) ? client : participant_of(client);
    *body_offset = kCdrHeaderSize;
    return {};
  }
  if (bytes.size() < kCdrHeaderSize + kCycloneHeaderSize) {
    return Status(StatusCode::corrupt, "neither a related sample identity nor a request header");
  }
  address->framing = Framing::cyclone;
  address->reader = participant_of(meta.id.writer);
  std::memcpy(address->header.data(), bytes.data() + kCdrHeaderSize, kCycloneHeaderSize);
  if (*swap) {  // two integers of 8 bytes; replies are in this host's order
    std::reverse(address->header.begin(), address->header.begin() + 8);
    std::reverse(address->header.begin() + 8, address->header.end());
  }
  *body_offset = kCdrHeaderSize + kCycloneHeaderSize;
  return {};
}

std::vector<std::uint8_t> frame_reply(const ReplyAddress& address, const MessageRef& response) {
  const std::size_t extra = address.framing == Framing::cyclone ? kCycloneHeaderSize : 0;
  const std::size_t size = response.encoded_size(response.message);
  std::vector<std::uint8_t> bytes(extra + size);
  if (response.encode(response.message, bytes.data() + extra, size) == 0) return {};
  if (extra != 0) {  // 16 bytes do not change the alignment of what follows
    std::memcpy(bytes.data(), bytes.data() + extra, kCdrHeaderSize);
    std::memcpy(bytes.data() + kCdrHeaderSize, address.header.data(), extra);
  }
  return bytes;
}

Result<std::shared_ptr<RawServer>> make_server(const Participant& participant,
                                               const ServiceSpec& spec, std::size_t max_request,
                                               RequestDecode decode) {
  auto server =
      std::make_shared<Server>(participant, spec.request.dds_topic, max_request, std::move(decode));
  if (Status s = server->open(spec); !s.ok()) return s;
  // What waits on the task thread may hold the server for longer than its owner does.
  return std::shared_ptr<RawServer>(server.get(), [server](RawServer*) { server->stop(); });
}

}  // namespace bpa::wire::detail
