// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "server/web/polls.hpp"

#include <algorithm>
#include <optional>
#include <utility>

#include "core/base/guarded.hpp"

namespace bpa::server::web {

Polls::Polls(Feed& feed, std::function<double()> rate_hz,
             std::function<std::string(const Poll&)> make_answer)
    : feed_(feed),
      rate_hz_(std::move(rate_hz)),
      make_answer_(std::move(make_answer)),
      thread_([this](const std::stop_token& stop) { run(stop); }) {
  feed_.on_change([this] {
    const std::lock_guard<std::mutex> lock(mutex_);
    news_ = true;
    wake_.notify_one();
  });
}

Polls::~Polls() { feed_.on_change(nullptr); }

void Polls::add(Poll poll) {
  std::optional<Poll> earlier;
  {
    const Clock::time_point now = Clock::now();
    const std::chrono::duration<double> period(1 / rate_hz_());
    const std::lock_guard<std::mutex> lock(mutex_);
    if (const auto found = waiting_.find(poll.viewer); found != waiting_.end()) {
      earlier = std::move(found->second.poll);
    }
    const auto answered = answered_.find(poll.viewer);
    const Clock::time_point earliest =
        answered == answered_.end()
            ? now
            : answered->second + std::chrono::duration_cast<Clock::duration>(period);
    const std::string viewer = poll.viewer;
    waiting_[viewer] = {std::move(poll), earliest, now + kLongestWait};
    news_ = true;
    wake_.notify_one();
  }
  if (earlier) earlier->respond(json_response("{}"));
}

std::vector<Poll> Polls::take_due(Clock::time_point now) {
  std::vector<Poll> due;
  const std::uint64_t sequence = feed_.sequence();
  for (auto entry = waiting_.begin(); entry != waiting_.end();) {
    const Waiting& one = entry->second;
    const bool has_news = one.poll.sequence != sequence && now >= one.earliest;
    if (!has_news && now < one.latest) {
      ++entry;
      continue;
    }
    answered_[entry->first] = now;
    due.push_back(std::move(entry->second.poll));
    entry = waiting_.erase(entry);
  }
  std::erase_if(answered_, [now](const auto& one) { return now - one.second > kLongestWait; });
  return due;
}

Polls::Clock::time_point Polls::next_due(Clock::time_point now) const {
  Clock::time_point next = now + kLongestWait;
  const std::uint64_t sequence = feed_.sequence();
  for (const auto& [viewer, one] : waiting_) {
    next = std::min(next, one.poll.sequence != sequence ? one.earliest : one.latest);
  }
  return next;
}

void Polls::run(const std::stop_token& stop) {
  std::unique_lock<std::mutex> lock(mutex_);
  while (!stop.stop_requested()) {
    if (waiting_.empty()) {
      wake_.wait(lock, stop, [this] { return !waiting_.empty(); });
    } else {
      wake_.wait_until(lock, stop, next_due(Clock::now()), [this] { return news_; });
    }
    news_ = false;
    const std::vector<Poll> due = take_due(Clock::now());
    lock.unlock();
    for (const Poll& poll : due) {
      const Status status = guarded("an answer to a viewer failed",
                                    [&] { poll.respond(json_response(make_answer_(poll))); });
      if (!status.ok()) poll.respond(refusal(status));
    }
    lock.lock();
  }
}

}  // namespace bpa::server::web
