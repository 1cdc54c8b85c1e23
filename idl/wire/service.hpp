// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <chrono>
#include <functional>
#include <limits>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "idl/wire/endpoint.hpp"

// Requests and replies as ROS 2 makes them. A `Service` is a struct with the types Request and
// Response, such as bpa_msgs::Detect.
//
// A server serves both framings at once. rmw_fastrtps: the request's identity beside the payload.
// rmw_cyclonedds: 16 bytes in front of it. Our client uses the first.

namespace bpa::wire {

/// What became of a service's requests and replies.
struct ServiceStatistics {
  std::uint64_t received = 0;         ///< Handed to the handler.
  std::uint64_t malformed = 0;        ///< No legal encoding of a request, or too large.
  std::uint64_t lost = 0;             ///< Requests that DDS reported lost or rejected.
  std::uint64_t replies_dropped = 0;  ///< Not sent: the client went or does not listen.
};

namespace detail {

/// One request that waits for its reply.
struct PendingReply {
  Guid client;  ///< The participant that asked; entity 0.
  std::function<Status(const MessageRef&)> send;
  std::atomic<bool> answered{false};
};

/// Hands a decoded request to its handler.
using Handle = std::function<void(std::shared_ptr<PendingReply>)>;
using RequestDecode = std::function<Result<Handle>(CdrReader& reader)>;

class RawServer {
 public:
  virtual ~RawServer() = default;
  virtual ServiceStatistics statistics() const = 0;
};

class RawClient {
 public:
  virtual ~RawClient() = default;
  /// Whether a server is there, or came before the time was over.
  virtual bool wait(std::chrono::milliseconds timeout) const = 0;
  /// The encoded reply.
  virtual Result<std::vector<std::uint8_t>> call(const MessageRef& request,
                                                 std::chrono::milliseconds timeout) = 0;
};

/// The ends of a service, in DDS's names.
struct ServiceSpec {
  std::string name;  ///< Resolved.
  EndpointSpec request, reply;
};

template <class Service>
Result<ServiceSpec> service_spec(const Participant& participant, std::string_view service,
                                 const Qos& qos) {
  Result<std::string> name = participant.resolve(service);
  if (!name.ok()) return name.status();
  return ServiceSpec{*name,
                     endpoint_spec<typename Service::Request>(dds_request_topic_name(*name), qos),
                     endpoint_spec<typename Service::Response>(dds_reply_topic_name(*name), qos)};
}

/// Withdraws the service when the last copy of the pointer goes, even while requests are open.
Result<std::shared_ptr<RawServer>> make_server(const Participant& participant,
                                               const ServiceSpec& spec, std::size_t max_request,
                                               RequestDecode decode);
Result<std::unique_ptr<RawClient>> make_client(const Participant& participant,
                                               const ServiceSpec& spec);

}  // namespace detail

/// The right to answer one request, once, from any thread, at any later time. Copies share it.
template <class Service>
class ReplyToken {
 public:
  explicit ReplyToken(std::shared_ptr<detail::PendingReply> pending)
      : pending_(std::move(pending)) {}

  /// Never blocks: the reply is sent as soon as the client can hear it. `unavailable` when the
  /// server is gone, `busy` when too many replies wait, `invalid_argument` on the second call.
  Status reply(const typename Service::Response& response) const {
    if (pending_->answered.exchange(true)) {
      return invalid_argument("this request has been answered already");
    }
    return pending_->send(detail::message_ref(response));
  }
  /// The participant that asked: its entity id is zero.
  Guid client() const { return pending_->client; }

 private:
  std::shared_ptr<detail::PendingReply> pending_;
};

/// Offers a service until its last copy is destroyed; after that the handler does not run.
template <class Service>
class ServiceServer {
 public:
  using Request = typename Service::Request;
  using Response = typename Service::Response;
  /// Runs on a DDS thread: keep the token, hand the request to a worker and return. It may run
  /// before `create` returns.
  using Handler = std::function<void(Request&&, ReplyToken<Service>)>;

  /// Requests of more than `max_request` bytes count as malformed and are not decoded.
  static Result<ServiceServer> create(
      const Participant& participant, std::string_view service, Handler handler,
      const Qos& qos = qos::services(),
      std::size_t max_request = std::numeric_limits<std::size_t>::max()) {
    auto spec = detail::service_spec<Service>(participant, service, qos);
    if (!spec.ok()) return spec.status();
    auto decode = [handler = std::move(handler)](CdrReader& reader) -> Result<detail::Handle> {
      auto request = std::make_shared<Request>();
      reader.read(*request);
      if (!reader.ok()) return reader.status(Request::kType);
      return detail::Handle([&handler, request](std::shared_ptr<detail::PendingReply> pending) {
        handler(std::move(*request), ReplyToken<Service>(std::move(pending)));
      });
    };
    auto impl = detail::make_server(participant, *spec, max_request, std::move(decode));
    if (!impl.ok()) return impl.status();
    return ServiceServer(spec->name, std::move(impl).value());
  }

  /// The resolved name.
  const std::string& name() const { return name_; }
  ServiceStatistics statistics() const { return impl_->statistics(); }

 private:
  ServiceServer(std::string name, std::shared_ptr<detail::RawServer> impl)
      : name_(std::move(name)), impl_(std::move(impl)) {}

  std::string name_;
  std::shared_ptr<detail::RawServer> impl_;
};

/// Calls a service. Thread-safe; several calls may wait at once. Servers may come and go.
template <class Service>
class ServiceClient {
 public:
  using Request = typename Service::Request;
  using Response = typename Service::Response;

  static Result<ServiceClient> create(const Participant& participant, std::string_view service,
                                      const Qos& qos = qos::services()) {
    auto spec = detail::service_spec<Service>(participant, service, qos);
    if (!spec.ok()) return spec.status();
    auto impl = detail::make_client(participant, *spec);
    if (!impl.ok()) return impl.status();
    return ServiceClient(spec->name, std::move(impl).value());
  }

  /// Whether a server is there, or came before the time was over.
  bool wait_for_service(std::chrono::milliseconds timeout) const { return impl_->wait(timeout); }

  /// Sends a request and waits for its reply. A server that comes while it waits gets the request,
  /// too: servers must bear it twice. The time includes waiting for a server: `unavailable`
  /// when none came or it went (a server that was killed counts as there for 5 s), `timeout` when
  /// no answer did, `corrupt` when the answer cannot be read, `busy` when as many calls wait as the
  /// history of `qos` holds requests.
  Result<Response> call(const Request& request, std::chrono::milliseconds timeout) const {
    auto bytes = impl_->call(detail::message_ref(request), timeout);
    if (!bytes.ok()) return bytes.status();
    Response response;
    Status status = decode(bytes->data(), bytes->size(), response);
    if (!status.ok()) return status;
    return response;
  }

  /// The resolved name.
  const std::string& name() const { return name_; }

 private:
  ServiceClient(std::string name, std::unique_ptr<detail::RawClient> impl)
      : name_(std::move(name)), impl_(std::move(impl)) {}

  std::string name_;
  std::unique_ptr<detail::RawClient> impl_;
};

}  // namespace bpa::wire
