// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "server/web/access.hpp"

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <string_view>

#include <arpa/inet.h>
#include <sys/random.h>
#include <sys/stat.h>
#include <unistd.h>

#include "core/base/concat.hpp"
#include "core/base/failure.hpp"
#include "core/io/file_bytes.hpp"

namespace bpa::server::web {
namespace {

/// Three viewers at 10 Hz ask for an answer and two pictures each, 90 requests a second.
constexpr double kMaxRequestsPerSecond = 300;
constexpr double kMaxBurst = 600;  ///< Requests after a pause: the page's files and pictures.
constexpr std::size_t kMaxAddresses = 1024;
constexpr std::size_t kTokenBytes = 16;  ///< 128 bits cannot be guessed.
constexpr std::size_t kMinToken = 16;
constexpr std::size_t kMaxToken = 256;

bool is_numeric(const std::string& address) {
  std::uint8_t bytes[16];
  return inet_pton(AF_INET, address.c_str(), bytes) == 1 ||
         inet_pton(AF_INET6, address.c_str(), bytes) == 1;
}

/// Compares all bytes, so that the time does not tell how many are right.
bool same_text(std::string_view a, std::string_view b) {
  if (a.size() != b.size()) return false;  // how long a token is may be known
  unsigned differs = 0;
  for (std::size_t i = 0; i < a.size(); ++i) differs |= static_cast<unsigned>(a[i] ^ b[i]);
  return differs == 0;
}

std::string lower(std::string text) {
  std::ranges::transform(text, text.begin(), [](unsigned char c) { return std::tolower(c); });
  return text;
}

/// "host" of "host:port" and of "[host]:port", in lower case.
std::string host_name(const std::string& host) {
  std::string name = host.substr(0, host.starts_with('[') ? host.find(']') : host.rfind(':'));
  if (name.starts_with('[')) name.erase(0, 1);
  return lower(name);
}

std::string own_name() {
  char name[256] = {};
  return gethostname(name, sizeof name - 1) == 0 ? name : "";
}

bool is_token(const std::string& text) {
  const auto legal = [](unsigned char c) {
    return std::isalnum(c) != 0 || c == '_' || c == '-' || c == '.';
  };
  return text.size() >= kMinToken && text.size() <= kMaxToken && std::ranges::all_of(text, legal);
}

}  // namespace

bool ListenAddress::is_loopback() const { return address == "::1" || address.starts_with("127."); }

std::string ListenAddress::host() const {
  if ((address == "0.0.0.0" || address == "::") && !own_name().empty()) return own_name();
  return address.find(':') == address.npos ? address : "[" + address + "]";
}

Result<ListenAddress> parse_listen(const std::string& text) {
  const auto wrong = [&text](const char* what) {
    return invalid_argument("web.listen is \"", text, "\": ", what,
                            "; it must be PORT or ADDRESS:PORT, such as 8080, 0.0.0.0:8080 or "
                            "[::1]:8080");
  };
  ListenAddress listen;
  const std::size_t colon = text.rfind(':');
  const std::string port = colon == text.npos ? text : text.substr(colon + 1);
  const auto end = std::from_chars(port.data(), port.data() + port.size(), listen.port);
  if (port.empty() || end.ec != std::errc() || end.ptr != port.data() + port.size()) {
    return wrong("there is no port from 0 to 65535");
  }
  if (colon == text.npos) return listen;
  listen.address = text.substr(0, colon);
  if (listen.address.starts_with('[') && listen.address.ends_with(']')) {
    listen.address = listen.address.substr(1, listen.address.size() - 2);
  }
  if (listen.address == "localhost") listen.address = "127.0.0.1";
  if (!is_numeric(listen.address)) return wrong("the address is no number");
  return listen;
}

std::string make_token() {
  std::uint8_t bytes[kTokenBytes];
  if (getrandom(bytes, sizeof bytes, 0) != static_cast<ssize_t>(sizeof bytes)) {
    or_throw(Status(StatusCode::unavailable, "the system gives no random numbers for a token"));
  }
  std::string token;
  for (const unsigned byte : bytes) token += format("%02x", byte);
  return token;
}

Result<std::string> read_token(const std::string& path) {
  struct stat about {};
  if (stat(path.c_str(), &about) != 0) {
    return not_found("web.token_file ", path, " cannot be read: ", std::strerror(errno));
  }
  constexpr mode_t kOthers = 077;
  if ((about.st_mode & kOthers) != 0) {
    return invalid_argument("web.token_file ", path, " has mode ",
                            format("%04o", about.st_mode & 07777U),
                            "; it must be 0600, so that its owner alone can read it");
  }
  const Result<std::string> bytes = io::read_file(path);
  if (!bytes.ok()) return bytes.status();
  std::string token = bytes->substr(0, bytes->find_first_of("\r\n"));
  if (is_token(token)) return token;
  return invalid_argument("web.token_file ", path, " must begin with a line of ", kMinToken, " to ",
                          kMaxToken, " letters, digits, '_', '-' and '.'");
}

Access::Access(const ListenAddress& listen, std::string token, std::vector<std::string> hosts)
    : loopback_(listen.is_loopback()), token_(std::move(token)), hosts_(std::move(hosts)) {
  for (std::string& host : hosts_) host = lower(std::move(host));
}

/// A site that makes its own name resolve to this machine is told by the name in Host. Numbers
/// cannot be made to resolve to anything.
bool Access::host_allowed(const std::string& host) const {
  const std::string name = host_name(host);
  if (std::ranges::find(hosts_, name) != hosts_.end()) return true;
  if (name == "localhost" || name == "127.0.0.1" || name == "::1") return true;
  return !loopback_ && (is_numeric(name) || (!name.empty() && name == lower(own_name())));
}

bool Access::spend(const Address& address, Clock::time_point now) {
  if (allowances_.size() >= kMaxAddresses && !allowances_.contains(address)) allowances_.clear();
  const auto [entry, is_new] = allowances_.try_emplace(address, Allowance{kMaxBurst, now});
  Allowance& allowance = entry->second;
  const std::chrono::duration<double> since = now - allowance.at;
  allowance.requests =
      std::min(kMaxBurst, allowance.requests + kMaxRequestsPerSecond * since.count());
  allowance.at = now;
  if (allowance.requests < 1) return false;
  --allowance.requests;
  return true;
}

std::optional<Refused> Access::check(const RequestHead& head, Right right, Clock::time_point now) {
  const auto refused = [](Refusal cause, int status, std::string why) {
    return Refused{cause, status, invalid_argument(std::move(why))};
  };
  if (!spend(head.address, now)) {
    return refused(Refusal::rate, 429,
                   concat("more than ", kMaxRequestsPerSecond,
                          " requests a second came from your address; ask for less"));
  }
  if (!host_allowed(head.host)) {
    return refused(Refusal::host, 403,
                   "this server is not known as \"" + head.host.substr(0, 100) +
                       "\"; use its address, or add the name to web.hosts");
  }
  const bool own = head.origin.empty() || head.origin == "http://" + head.host ||
                   head.origin == "https://" + head.host;
  const std::string& site = head.fetch_site;
  if (!own || (site != "" && site != "same-origin" && site != "none")) {
    return refused(Refusal::origin, 403, "the request comes from the page of another site");
  }
  const std::string given =
      head.authorization.starts_with("Bearer ") ? head.authorization.substr(7) : "";
  if (token_.empty() || right == Right::everyone || same_text(token_, given)) return {};
  return refused(Refusal::token, 401,
                 given.empty() ? "a token is needed: open the address that the server printed when "
                                 "it started, or send \"Authorization: Bearer TOKEN\""
                               : "the token is wrong: it is the one that the server printed when "
                                 "it started, or that web.token_file holds");
}

}  // namespace bpa::server::web
