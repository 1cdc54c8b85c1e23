// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/base/status.hpp"
#include "server/web/http.hpp"

// Who may use the page. Other web sites in the user's browser may not: Host and Origin are checked,
// and nothing is granted by a cookie. Other machines need a token.

namespace bpa::server::web {

struct ListenAddress {
  std::string address = "127.0.0.1";  ///< Of this machine, numeric.
  std::uint16_t port = 0;             ///< 0: the system chooses one.

  /// Only this machine can connect.
  bool is_loopback() const;
  /// As in the address of a page: the machine's name where it listens at all its addresses.
  std::string host() const;
};

/// "[ADDRESS:]PORT", such as "8080", "0.0.0.0:8080", "[::1]:8080". A port alone is on loopback.
/// Fails with invalid_argument.
Result<ListenAddress> parse_listen(const std::string& text);

/// 32 hex digits from the system's source of random numbers.
std::string make_token();
/// The first line of a file, 16 to 256 letters, digits, '_', '-' and '.'. Fails with not_found, and
/// with invalid_argument for another content or where others than the owner may read the file.
Result<std::string> read_token(const std::string& path);

/// Why a request is refused.
enum class Refusal : std::uint8_t { host, origin, token, rate, path, method, size, busy };
inline constexpr const char* kRefusalNames[] = {
    "foreign host", "foreign origin", "no token",       "too many",
    "no such path", "wrong method",   "body too large", "busy"};
inline constexpr std::size_t kRefusals = std::size(kRefusalNames);

struct Refused {
  Refusal cause{};
  int status = 403;
  Status why;
};

/// Not thread-safe.
class Access {
 public:
  using Clock = std::chrono::steady_clock;

  /// An empty token asks for none. `hosts` are more names of this machine that a browser may use.
  Access(const ListenAddress& listen, std::string token, std::vector<std::string> hosts);

  /// Nothing where the request may go on. `right`: of the route that will serve it.
  std::optional<Refused> check(const RequestHead& head, Right right,
                               Clock::time_point now = Clock::now());

 private:
  /// Requests that an address may still make, and when that was counted.
  struct Allowance {
    double requests = 0;
    Clock::time_point at{};
  };
  bool spend(const Address& address, Clock::time_point now);
  bool host_allowed(const std::string& host) const;

  const bool loopback_;
  const std::string token_;
  std::vector<std::string> hosts_;
  std::map<Address, Allowance> allowances_;
};

}  // namespace bpa::server::web
