// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "server/log_filter.hpp"

#include <algorithm>
#include <utility>

#include "core/base/concat.hpp"

namespace bpa::server {
namespace {

constexpr std::size_t kMaxCauses = 256;
constexpr auto kQuiet = std::chrono::seconds(5);

/// Bytes of the UTF-8 character at the start of a text that a terminal shows as it is; 0: none.
std::size_t shown_character(std::string_view text) {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  const unsigned first = byte(0);
  if (first < 0x80) return first >= 0x20 && first != 0x7f ? 1 : 0;
  const std::size_t size = first >= 0xf0 ? 4 : first >= 0xe0 ? 3 : 2;
  if (first < 0xc2 || first > 0xf4 || text.size() < size) return 0;
  for (std::size_t i = 1; i < size; ++i) {
    if ((byte(i) & 0xc0U) != 0x80) return 0;
  }
  const bool control = first == 0xc2 && byte(1) < 0xa0;  // U+0080 to U+009F
  const bool overlong = (first == 0xe0 && byte(1) < 0xa0) || (first == 0xf0 && byte(1) < 0x90);
  return control || overlong ? 0 : size;
}

std::string cause_of(std::string_view text) {
  constexpr std::size_t kLongest = 80;
  std::string cause(text.substr(0, std::min(text.find(':'), kLongest)));
  std::erase_if(cause, [](char c) { return c >= '0' && c <= '9'; });
  return cause;
}

}  // namespace

std::string printable(std::string_view text, std::size_t most) {
  constexpr char kDigits[] = "0123456789abcdef";
  std::string line;
  std::size_t at = 0;
  while (at < text.size() && line.size() < most) {
    if (const std::size_t size = shown_character(text.substr(at)); size > 0) {
      line += text.substr(at, size);
      at += size;
      continue;
    }
    const auto byte = static_cast<unsigned char>(text[at++]);
    if (byte == '\n' || byte == '\t') {
      line += byte == '\n' ? "\\n" : "\\t";
    } else {
      line += std::string("\\x") + kDigits[byte >> 4] + kDigits[byte & 15];
    }
  }
  if (at < text.size()) line += concat("... (", text.size(), " bytes)");
  return line;
}

bool LogFilter::Bucket::take(TimePoint now) {
  const std::chrono::duration<double> passed = now - last_;
  if (last_ != TimePoint()) tokens_ = std::min(most_, tokens_ + rate_ * passed.count());
  last_ = now;
  if (tokens_ < 1) return false;
  tokens_ -= 1;
  return true;
}

std::optional<std::string> LogFilter::pass(LogLevel level, const LogMessage& message,
                                           TimePoint now) {
  if (level == LogLevel::debug) return printable(message.text);
  const std::pair key(cause_of(message.text), std::string(message.peer));
  if (causes_.size() >= kMaxCauses && causes_.count(key) == 0) forget_oldest();
  Cause& cause = causes_[key];
  cause.last = now;
  if (!cause.bucket.take(now) || !all_.take(now)) {
    ++cause.left_out;
    return std::nullopt;
  }
  std::string line = printable(message.text);
  if (const auto count = std::exchange(cause.left_out, 0); count > 0) {
    line += concat(" (", count, " like it before were not logged)");
  }
  return line;
}

std::vector<std::string> LogFilter::left_out(TimePoint now) {
  std::vector<std::string> lines;
  for (auto& [key, cause] : causes_) {
    if (cause.left_out == 0 || now - cause.last < kQuiet) continue;
    const auto& [text, peer] = key;
    lines.push_back(concat(std::exchange(cause.left_out, 0), " messages ",
                           peer.empty() ? "" : "caused by " + printable(peer) + " ",
                           "were not logged: ", printable(text), " ..."));
  }
  return lines;
}

/// What it left out counts for the cause "others".
void LogFilter::forget_oldest() {
  const auto oldest =
      std::ranges::min_element(causes_, {}, [](const auto& entry) { return entry.second.last; });
  const Cause gone = oldest->second;
  causes_.erase(oldest);
  if (gone.left_out == 0) return;
  Cause& others = causes_[{"others", ""}];
  others.left_out += gone.left_out;
  others.last = std::max(others.last, gone.last);
}

}  // namespace bpa::server
