// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
// CDR: every type of this project, requests in both framings, and what is made of them.
#include "idl/wire/messages.hpp"

#include <algorithm>
#include <iterator>
#include <tuple>
#include <type_traits>

#include "client/src/convert.hpp"
#include "idl/wire/cdr.hpp"
#include "idl/wire/private/announcements.hpp"
#include "idl/wire/private/service_framing.hpp"
#include "server/parameters.hpp"
#include "tests/fuzz/target.hpp"
#include "tests/idl/wire/all_types.hpp"
#include "tests/support/wall_messages.hpp"

namespace bpa::fuzz {
namespace {

namespace msgs = wire::bpa_msgs;
namespace rcl = wire::rcl_interfaces;
namespace sensor = wire::sensor_msgs;

const std::uint8_t* data_of(std::string_view bytes) {
  return reinterpret_cast<const std::uint8_t*>(bytes.data());
}

template <class T>
std::string encoded(const T& message) {
  const std::vector<std::uint8_t> bytes = wire::encode(message);
  return {bytes.begin(), bytes.end()};
}

using wire::AllTypes;
constexpr std::size_t kTypes = std::tuple_size_v<AllTypes>;

/// What was decoded, encoded again, is its own decoding.
template <class T>
void run_one(std::string_view bytes) {
  T message{};
  if (!wire::decode(data_of(bytes), bytes.size(), message).ok()) return;
  const std::string once = encoded(message);
  T again{};
  require(wire::decode(data_of(once), once.size(), again).ok(), "what was encoded can be decoded");
  require(encoded(again) == once, "decoding loses nothing");
}

template <std::size_t... k>
void run_type(std::size_t type, std::string_view bytes, std::index_sequence<k...>) {
  ((type == k ? run_one<std::tuple_element_t<k, AllTypes>>(bytes) : void()), ...);
}

/// The first byte is the type's number.
void run_cdr(std::string_view bytes) {
  if (bytes.empty()) return;
  run_type(static_cast<std::uint8_t>(bytes[0]) % kTypes, bytes.substr(1),
           std::make_index_sequence<kTypes>());
}

/// A message behind its type's number.
template <class T>
std::string numbered(const T& message) {
  const auto number = []<class... Types>(std::tuple<Types...>*) {
    const bool is_it[] = {std::is_same_v<T, Types>...};
    return std::find(std::begin(is_it), std::end(is_it), true) - std::begin(is_it);
  }(static_cast<AllTypes*>(nullptr));
  return static_cast<char>(number) + encoded(message);
}

template <std::size_t... k>
std::vector<std::string> empty_messages(std::index_sequence<k...>) {
  return {numbered(std::tuple_element_t<k, AllTypes>())...};
}

std::vector<std::string> cdr_seeds() {
  std::vector<std::string> seeds = empty_messages(std::make_index_sequence<kTypes>());
  seeds.push_back(numbered(support::wall_camera_info(7)));
  rcl::SetParameters_Request request;
  request.parameters = server::all_parameters(server::ServerOptions());
  request.parameters.resize(9);
  seeds.push_back(numbered(request));
  return seeds;
}

/// A first byte with the framing of the metadata, then a request.
void run_request(std::string_view bytes) {
  if (bytes.empty()) return;
  wire::SampleMeta meta;
  if ((bytes[0] & 1) != 0) meta.related.writer.fill(1);
  const std::vector<std::uint8_t> request(bytes.begin() + 1, bytes.end());
  wire::detail::ReplyAddress address;
  std::size_t offset = 0;
  bool swap = false;
  if (!wire::detail::read_request_frame(request, meta, &address, &offset, &swap).ok()) return;
  require(offset <= request.size(), "a request begins inside its bytes");
  wire::CdrReader reader(request.data() + offset, request.size() - offset, swap);
  msgs::Detect_Request message;
  reader.read(message);
  (void)reader.status(msgs::Detect_Request::kType);
}

std::vector<std::string> request_seeds() {
  const std::string plain = encoded(msgs::Detect_Request());
  return {'\1' + plain, '\0' + plain.substr(0, 4) + std::string(16, '\7') + plain.substr(4)};
}

/// What a server answers, as the SDK takes it.
void run_answers(std::string_view bytes) {
  msgs::SceneInterpretations scene;
  if (wire::decode(data_of(bytes), bytes.size(), scene).ok()) (void)sdk::to_detections(scene);
  msgs::GetStatus_Response status;
  if (wire::decode(data_of(bytes), bytes.size(), status).ok()) (void)sdk::to_server_status(status);
  msgs::ModelInfo model;
  if (wire::decode(data_of(bytes), bytes.size(), model).ok()) (void)sdk::to_model(model);
  sensor::Image image;
  if (wire::decode(data_of(bytes), bytes.size(), image).ok()) {
    const auto annotated = sdk::to_image(std::move(image));
    require(!annotated.ok() ||
                annotated->rgb.size() == std::size_t{3} * annotated->width * annotated->height,
            "an annotated image has all its pixels");
  }
  if (msgs::Tracks tracks; wire::decode(data_of(bytes), bytes.size(), tracks).ok()) {
    require(sdk::to_tracks(tracks).tracks.size() == tracks.tracks.size(), "no track is lost");
  }
  msgs::RgbdFrame frame;
  if (!wire::decode(data_of(bytes), bytes.size(), frame).ok()) return;
  if (const auto view = sdk::to_view(frame); view.ok()) {
    require(sdk::check(*view).ok(), "a frame of another client has all its pixels");
  }
}

std::vector<std::string> answer_seeds() {
  msgs::SceneInterpretations scene;
  scene.header = support::header(5);
  scene.interpretations.resize(1);
  scene.interpretations[0].placements.resize(1);
  msgs::Tracks tracks;
  tracks.header = support::header(5);
  tracks.tracks.resize(1);
  sensor::Image image = support::wall_color_image(1);
  image.width = 4;
  image.height = 2;
  image.step = 12;
  image.data.resize(24);
  msgs::RgbdFrame frame = support::wall_frame();
  frame.width = 4;
  frame.height = 2;
  frame.color.resize(24);
  frame.depth.resize(16);
  return {encoded(scene),
          encoded(msgs::GetStatus_Response()),
          encoded(msgs::ModelInfo()),
          encoded(image),
          encoded(frame),
          encoded(tracks)};
}

/// SetParameters, and what a client may ask of parameters by name.
void run_parameters(std::string_view bytes) {
  rcl::SetParameters_Request request;
  if (wire::decode(data_of(bytes), bytes.size(), request).ok()) {
    server::ServerOptions options;
    for (const rcl::Parameter& parameter : request.parameters) {
      (void)server::set_parameter(parameter, options);
      (void)server::describe_parameter(parameter.name);
    }
    (void)server::validate(options);
  }
  rcl::ListParameters_Request list;
  if (wire::decode(data_of(bytes), bytes.size(), list).ok()) {
    (void)server::list_parameters(list.prefixes, list.depth);
  }
}

std::vector<std::string> parameter_seeds() {
  std::vector<std::string> seeds;
  for (const rcl::Parameter& parameter : server::all_parameters(server::ServerOptions())) {
    if (parameter.name.find("detector.") == 0) continue;
    rcl::SetParameters_Request request;
    request.parameters = {parameter};
    seeds.push_back(encoded(request));
  }
  rcl::ListParameters_Request list;
  list.prefixes = {"detection", "log.level"};
  list.depth = 2;
  seeds.push_back(encoded(list));
  return seeds;
}

/// An announcement whose lease was made endless is the same with an endless lease.
void run_announcements(std::string_view bytes) {
  namespace detail = wire::detail;
  std::vector<std::uint8_t> packet(bytes.begin(), bytes.end());
  const auto found = detail::announcements_in(packet.data(), packet.size());
  for (const auto& announcement : found) {
    if (announcement.lease_at == 0) continue;
    require(announcement.lease_at + 8 <= packet.size(), "the lease is in the packet");
    detail::make_lease_endless(packet.data(), announcement);
  }
  const auto again = detail::announcements_in(packet.data(), packet.size());
  require(again.size() == found.size(), "an announcement stays one");
}

/// One that comes with a lease of 5 s, and one that leaves.
std::vector<std::string> announcement_seeds() {
  const wire::detail::GuidPrefix prefix{1, 15, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11};
  const auto leaves = wire::detail::departure(prefix, 2);
  const std::vector<std::uint8_t> own(prefix.begin(), prefix.end());
  std::vector<std::uint8_t> comes(leaves.begin(), leaves.begin() + 20);
  const auto add = [&](const std::vector<std::uint8_t>& more) {
    comes.insert(comes.end(), more.begin(), more.end());
  };
  add({0x15, 5, 0, 0, 0, 0, 16, 0, 0, 1, 0, 0xc7, 0, 1, 0, 0xc2, 0, 0, 0, 0, 1, 0, 0, 0});
  add({0, 3, 0, 0, 0x50, 0, 16, 0});
  add(own);
  add({0, 0, 1, 0xc1, 2, 0, 8, 0, 5, 0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0});
  return {{comes.begin(), comes.end()}, {leaves.begin(), leaves.end()}};
}

}  // namespace

std::vector<Target> message_targets() {
  return {{"announcements", "idl/wire/announcements.cpp", run_announcements, announcement_seeds,
           1024, 4},
          {"cdr", "idl/wire/cdr.hpp", run_cdr, cdr_seeds, 2048, 4},
          {"request", "idl/wire/service_server.cpp", run_request, request_seeds, 1024, 4},
          {"answers", "client/src/convert.cpp", run_answers, answer_seeds, 2048, 4},
          {"parameters", "server/parameters.cpp", run_parameters, parameter_seeds, 1024, 4}};
}

}  // namespace bpa::fuzz
