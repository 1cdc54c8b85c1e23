// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
// Preloaded into a process (LD_PRELOAD), this makes what it sends over UDP as lossy as a bad link
// of Ethernet: of each 100 packets as many are lost as BPA_LOSS says, and a datagram is lost with
// any of the packets of at most 1480 bytes that it takes. Needs no rights, and touches no other
// process.
#include <cmath>
#include <cstdlib>
#include <mutex>
#include <random>

#include <dlfcn.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <sys/uio.h>

namespace {

bool is_lost(int socket, std::size_t bytes) {
  int type = 0, family = 0;
  socklen_t size = sizeof type;
  getsockopt(socket, SOL_SOCKET, SO_TYPE, &type, &size);
  getsockopt(socket, SOL_SOCKET, SO_DOMAIN, &family, &size);
  if (type != SOCK_DGRAM || family != AF_INET) return false;
  static const char* const text = std::getenv("BPA_LOSS");
  static const double loss = text == nullptr ? 0 : std::atof(text) / 100;
  static std::mutex mutex;
  static std::mt19937 random(1);
  constexpr double kUdpHeader = 8, kPacket = 1480;
  const double packets = std::ceil((static_cast<double>(bytes) + kUdpHeader) / kPacket);
  const std::lock_guard<std::mutex> lock(mutex);
  return std::uniform_real_distribution<double>()(random) > std::pow(1 - loss, packets);
}

template <class Function>
Function* next(const char* name) {
  return reinterpret_cast<Function*>(dlsym(RTLD_NEXT, name));
}

}  // namespace

extern "C" ssize_t sendmsg(int socket, const msghdr* message, int flags) {
  static auto* const send = next<ssize_t(int, const msghdr*, int)>("sendmsg");
  std::size_t bytes = 0;
  for (std::size_t i = 0; i < message->msg_iovlen; ++i) bytes += message->msg_iov[i].iov_len;
  if (is_lost(socket, bytes)) return static_cast<ssize_t>(bytes);
  return send(socket, message, flags);
}

extern "C" ssize_t sendto(int socket, const void* bytes, std::size_t size, int flags,
                          const sockaddr* to, socklen_t to_size) {
  static auto* const send =
      next<ssize_t(int, const void*, std::size_t, int, const sockaddr*, socklen_t)>("sendto");
  if (is_lost(socket, size)) return static_cast<ssize_t>(size);
  return send(socket, bytes, size, flags, to, to_size);
}
