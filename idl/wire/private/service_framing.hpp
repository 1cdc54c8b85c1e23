// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "idl/wire/endpoint.hpp"

// The two ways in which ROS 2 middlewares tell whose request a reply answers.
//
// rmw_fastrtps: the payload is the request or reply alone. The identity travels beside it, as
// RTPS's related sample identity: in a request the GUID of the client's reply reader; in a reply
// that GUID and the request's sequence number.
//
// rmw_cyclonedds: 16 bytes (client id, sequence number) stand between the CDR header and the
// struct; the reply repeats those of the request.

namespace bpa::wire::detail {

enum class Framing { fastdds, cyclone };

/// What a reply must carry to reach its client.
struct ReplyAddress {
  Framing framing = Framing::fastdds;
  SampleId related;                       ///< fastdds: what the reply is related to.
  std::array<std::uint8_t, 16> header{};  ///< cyclone: what stands before the struct.
  Guid client{};                          ///< The participant that asked; entity 0.
  Guid reader{};                          ///< The client's reply reader; entity 0: any of its own.
};

inline constexpr std::size_t kCycloneHeaderSize = 16;

/// Reads whose request it is. The struct starts at `body_offset`; `swap` is as in CdrReader.
/// `corrupt` when it is in neither framing.
Status read_request_frame(const std::vector<std::uint8_t>& bytes, const SampleMeta& meta,
                          ReplyAddress* address, std::size_t* body_offset, bool* swap);

/// The encoded reply as it goes on the wire.
std::vector<std::uint8_t> frame_reply(const ReplyAddress& address, const MessageRef& response);

}  // namespace bpa::wire::detail
