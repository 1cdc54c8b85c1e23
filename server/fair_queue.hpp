// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstddef>
#include <deque>
#include <functional>
#include <optional>
#include <utility>
#include <vector>

#include "core/base/status.hpp"

namespace bpa::server {

/// A request that waits to be handled.
struct Errand {
  std::function<void()> handle;
  /// Called instead, where others must go first.
  std::function<void(const Status&)> refuse;
};

/// A queue in which clients take turns: first in, first out for each client, one item of each
/// client in a round. A client that asks a lot delays itself, not the others. Not bounded and not
/// locked; its owner does both.
template <class Client, class T>
class FairQueue {
 public:
  /// How many items would come out before one that this client adds now.
  std::size_t ahead_of_next(const Client& client) const {
    const auto line_of = std::ranges::find(lines_, client, &Line::client);
    const std::size_t own = line_of == lines_.end() ? 0 : line_of->items.size();
    std::size_t ahead = own;
    bool before = true;  // whose turn comes before the client's; a new client's comes last
    for (const Line& line : lines_) {
      if (line.client == client) {
        before = false;
      } else {
        ahead += std::min(line.items.size(), before ? own + 1 : own);
      }
    }
    return ahead;
  }

  void push(const Client& client, T item) {
    auto line = std::ranges::find(lines_, client, &Line::client);
    if (line == lines_.end()) line = lines_.insert(lines_.end(), Line{client, {}});
    line->items.push_back(std::move(item));
    ++size_;
  }

  /// The item whose turn it is; its client goes to the end of the round. Nothing when empty.
  std::optional<T> pop() {
    if (lines_.empty()) return std::nullopt;
    Line line = std::move(lines_.front());
    lines_.pop_front();
    std::optional<T> item(std::move(line.items.front()));
    line.items.pop_front();
    if (!line.items.empty()) lines_.push_back(std::move(line));
    --size_;
    return item;
  }

  /// Makes room in a full queue: takes out the last item of the client that has most, if that is
  /// not `client` and would still have as many as `client` then. Nothing else is fair to displace.
  std::optional<T> displace_for(const Client& client) {
    const auto most = std::ranges::max_element(lines_, {}, length_of);
    if (most == lines_.end() || most->items.size() < count(client) + 2) return std::nullopt;
    return pop_last(most->client);
  }

  /// The clients that have items, and how many.
  std::vector<std::pair<Client, std::size_t>> counts() const {
    std::vector<std::pair<Client, std::size_t>> counts;
    for (const Line& line : lines_) counts.emplace_back(line.client, line.items.size());
    return counts;
  }

  /// The item that this client added last; nothing without one.
  std::optional<T> pop_last(const Client& client) {
    const auto line = std::ranges::find(lines_, client, &Line::client);
    if (line == lines_.end()) return std::nullopt;
    std::optional<T> item(std::move(line->items.back()));
    line->items.pop_back();
    if (line->items.empty()) lines_.erase(line);
    --size_;
    return item;
  }

  /// Items of one client.
  std::size_t count(const Client& client) const {
    const auto line = std::ranges::find(lines_, client, &Line::client);
    return line == lines_.end() ? 0 : line->items.size();
  }

  std::size_t size() const { return size_; }
  bool empty() const { return size_ == 0; }

 private:
  struct Line {
    Client client;
    std::deque<T> items;  ///< Never empty.
  };
  static std::size_t length_of(const Line& line) { return line.items.size(); }

  std::deque<Line> lines_;  ///< In the order of their turns.
  std::size_t size_ = 0;
};

}  // namespace bpa::server
