// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <condition_variable>
#include <map>
#include <mutex>
#include <set>

#include "core/base/concat.hpp"
#include "idl/wire/service.hpp"

namespace bpa::wire::detail {
namespace {

using std::chrono::milliseconds;
using Clock = std::chrono::steady_clock;
using Bytes = std::vector<std::uint8_t>;

/// A call that waits looks so often whether its server is still there.
constexpr milliseconds kLookAfterServer{100};

class Client : public RawClient {
 public:
  Status open(const Participant& participant, const ServiceSpec& spec) {
    name_ = spec.request.dds_topic;
    max_calls_ = static_cast<std::size_t>(spec.request.qos.depth);
    // The reader is a member: while it calls back, this exists.
    auto take = copy_bytes(
        [this](Bytes&& bytes, const SampleMeta& meta) { on_reply(std::move(bytes), meta); });
    auto reader = make_reader(participant, spec.reply, std::move(take));
    if (!reader.ok()) return reader.status();
    replies_ = std::move(reader).value();
    auto writer = make_writer(participant, spec.request);
    if (!writer.ok()) return writer.status();
    requests_ = std::move(writer).value();
    const std::lock_guard<std::mutex> lock(mutex_);
    our_ids_ = {replies_->guid(), requests_->guid()};
    return {};
  }

  bool wait(milliseconds timeout) const override {
    const Clock::time_point deadline = Clock::now() + timeout;
    return requests_->matches().wait_for(1, timeout) &&
           replies_->matches().wait_for(1, left(deadline));
  }

  Result<Bytes> call(const MessageRef& request, milliseconds timeout) override {
    const Clock::time_point deadline = Clock::now() + timeout;
    if (!wait(timeout)) return Status(StatusCode::unavailable, "nobody serves " + name_);
    {
      const std::lock_guard<std::mutex> lock(mutex_);
      if (calls_.size() + static_cast<std::size_t>(writing_) >= max_calls_) {
        return Status(StatusCode::busy, concat(max_calls_, " calls of ", name_,
                                               " wait for their replies, as many as may"));
      }
      ++writing_;
    }
    std::set<Guid> servers = requests_->matches().peers();
    std::vector<std::int64_t> sent;
    Status status = send(request, sent);
    if (!status.ok()) return status;

    std::unique_lock<std::mutex> lock(mutex_);
    const auto gone = [&] { return !requests_->matches().contains_any(servers); };
    while (!answer(sent) && Clock::now() < deadline && !gone()) {
      answered_.wait_until(lock, std::min(deadline, Clock::now() + kLookAfterServer));
      // A server that came meanwhile may have replaced one that died without a word.
      const std::set<Guid> now = requests_->matches().peers();
      if (std::includes(servers.begin(), servers.end(), now.begin(), now.end())) continue;
      servers.insert(now.begin(), now.end());
      ++writing_;
      lock.unlock();
      status = send(request, sent);
      lock.lock();
      if (!status.ok()) break;
    }
    Bytes result;
    if (Bytes* reply = answer(sent)) result = std::move(*reply);
    for (const std::int64_t sequence : sent) calls_.erase(sequence);
    if (!status.ok() && result.empty()) return status;
    if (result.empty() && gone()) {
      return Status(StatusCode::unavailable, "the server of " + name_ + " has gone");
    }
    if (result.empty()) {
      return Status(StatusCode::timeout,
                    name_ +
                        " did not answer in time: it is busy for longer, or the network lost "
                        "the request or its reply");
    }
    return result;
  }

 private:
  /// Writes the request once; `writing_` counts it already. Adds its number to those of the call.
  Status send(const MessageRef& request, std::vector<std::int64_t>& sent) {
    const SampleId related{replies_->guid()};
    SampleId written;
    const Status status = requests_->write(request, &related, &written);
    const std::lock_guard<std::mutex> lock(mutex_);
    --writing_;
    if (!status.ok()) return status;
    sent.push_back(written.sequence);
    Bytes& reply = calls_[written.sequence];
    if (auto early = early_.extract(written.sequence)) reply = std::move(early.mapped());
    if (writing_ == 0) early_.clear();
    return {};
  }

  /// The first reply to one of these requests; null without. The caller holds the mutex.
  Bytes* answer(const std::vector<std::int64_t>& sent) {
    for (const std::int64_t sequence : sent) {
      if (Bytes& reply = calls_[sequence]; !reply.empty()) return &reply;
    }
    return nullptr;
  }

  static milliseconds left(Clock::time_point deadline) {
    return std::max(std::chrono::duration_cast<milliseconds>(deadline - Clock::now()),
                    milliseconds{0});
  }

  void on_reply(Bytes bytes, const SampleMeta& meta) {
    const std::lock_guard<std::mutex> lock(mutex_);
    const Guid& addressee = meta.related.writer;
    if (std::find(our_ids_.begin(), our_ids_.end(), addressee) == our_ids_.end()) return;
    const auto call = calls_.find(meta.related.sequence);
    if (call != calls_.end()) {
      call->second = std::move(bytes);
    } else if (writing_ > 0) {  // perhaps of a request whose write has not returned yet
      early_[meta.related.sequence] = std::move(bytes);
    }
    answered_.notify_all();
  }

  std::string name_;
  std::size_t max_calls_ = 0;  ///< More would push others out of DDS's history.
  std::mutex mutex_;
  std::condition_variable answered_;
  std::vector<Guid> our_ids_;            ///< Of the reply reader and the request writer.
  std::map<std::int64_t, Bytes> calls_;  ///< By sequence number; empty: not answered yet.
  std::map<std::int64_t, Bytes> early_;  ///< Replies that came while a write was going on.
  int writing_ = 0;
  std::unique_ptr<RawReader> replies_;
  std::unique_ptr<RawWriter> requests_;
};

}  // namespace

Result<std::unique_ptr<RawClient>> make_client(const Participant& participant,
                                               const ServiceSpec& spec) {
  auto client = std::make_unique<Client>();
  if (Status s = client->open(participant, spec); !s.ok()) return s;
  return std::unique_ptr<RawClient>(std::move(client));
}

}  // namespace bpa::wire::detail
