// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "idl/wire/endpoint.hpp"

// Requests and replies as ROS 2 makes them. A `Service` is a struct with the types Request and
// Response, such as bpa_msgs::Detect.
//
// A server serves both framings at once: that of rmw_fastrtps, where the request's identity travels
// beside the payload, and that of rmw_cyclonedds, where 16 bytes in front of it do. A client of
// ours speaks the first.

namespace bpa::wire {

namespace detail {

class ServiceServerImpl;
class ServiceClientImpl;

/// One request that waits for its reply.
class PendingReply {
 public:
  virtual ~PendingReply() = default;
  virtual Status reply(const MessageRef& response) = 0;
  virtual Guid client() const = 0;
};

/// Decodes a request; gives back what hands it to the handler.
using RequestDecode =
    std::function<Result<std::function<void(std::shared_ptr<PendingReply>)>>(CdrReader& reader)>;

Result<std::shared_ptr<ServiceServerImpl>> make_server(const Participant& participant,
                                                       EndpointSpec request, EndpointSpec reply,
                                                       RequestDecode decode);
ReaderStatistics server_statistics(const ServiceServerImpl& server);
void stop_server(ServiceServerImpl& server);

Result<std::shared_ptr<ServiceClientImpl>> make_client(const Participant& participant,
                                                       EndpointSpec request, EndpointSpec reply);
bool client_wait(ServiceClientImpl& client, std::chrono::milliseconds timeout);
Result<std::vector<std::uint8_t>> client_call(ServiceClientImpl& client, const MessageRef& request,
                                              std::chrono::milliseconds timeout);

}  // namespace detail

/// The right to answer one request, once, from any thread, at any later time. Copies share it.
template <class Service>
class ReplyToken {
 public:
  explicit ReplyToken(std::shared_ptr<detail::PendingReply> pending)
      : pending_(std::move(pending)) {}

  /// Never blocks: the reply is sent now, or as soon as the client can hear it. `unavailable` when
  /// the server object is gone, `busy` when too many replies wait, `invalid_argument` on the second
  /// call.
  Status reply(const typename Service::Response& response) const {
    return pending_->reply(detail::message_ref(response));
  }
  /// The participant that asked: its entity id is zero.
  Guid client() const { return pending_->client(); }

 private:
  std::shared_ptr<detail::PendingReply> pending_;
};

/// Offers a service. It is withdrawn when destroyed; after that the handler is not running and will
/// not run.
template <class Service>
class ServiceServer {
 public:
  using Request = typename Service::Request;
  using Response = typename Service::Response;
  /// Runs on a DDS thread: keep the token, hand the request to a worker and return. It may run
  /// before `create` returns.
  using Handler = std::function<void(Request&&, ReplyToken<Service>)>;

  static Result<ServiceServer> create(const Participant& participant, std::string_view service,
                                      Handler handler, const Qos& qos = qos::services()) {
    Result<std::string> name = participant.resolve(service);
    if (!name.ok()) return name.status();
    auto decode = [handler = std::move(handler)](CdrReader& reader)
        -> Result<std::function<void(std::shared_ptr<detail::PendingReply>)>> {
      auto request = std::make_shared<Request>();
      reader.read(*request);
      if (!reader.ok()) {
        return Status(StatusCode::corrupt, std::string(Request::kType) + " field " +
                                               reader.field() + ": " + reader.error());
      }
      return std::function<void(std::shared_ptr<detail::PendingReply>)>(
          [&handler, request](std::shared_ptr<detail::PendingReply> pending) {
            handler(std::move(*request), ReplyToken<Service>(std::move(pending)));
          });
    };
    auto impl = detail::make_server(
        participant, detail::endpoint_spec<Request>(dds_request_topic_name(*name), qos, 0),
        detail::endpoint_spec<Response>(dds_reply_topic_name(*name), qos, 0), std::move(decode));
    if (!impl.ok()) return impl.status();
    return ServiceServer(*std::move(name), std::move(impl).value());
  }

  ServiceServer(ServiceServer&&) = default;
  ServiceServer& operator=(ServiceServer&& other) noexcept {
    if (impl_) detail::stop_server(*impl_);
    name_ = std::move(other.name_);
    impl_ = std::move(other.impl_);
    return *this;
  }
  ~ServiceServer() {
    if (impl_) detail::stop_server(*impl_);
  }

  /// The resolved name.
  const std::string& name() const { return name_; }
  ReaderStatistics statistics() const { return detail::server_statistics(*impl_); }

 private:
  ServiceServer(std::string name, std::shared_ptr<detail::ServiceServerImpl> impl)
      : name_(std::move(name)), impl_(std::move(impl)) {}

  std::string name_;
  std::shared_ptr<detail::ServiceServerImpl> impl_;
};

/// Calls a service. Thread-safe; several calls may wait at once. Servers may come and go.
template <class Service>
class ServiceClient {
 public:
  using Request = typename Service::Request;
  using Response = typename Service::Response;

  static Result<ServiceClient> create(const Participant& participant, std::string_view service,
                                      const Qos& qos = qos::services()) {
    Result<std::string> name = participant.resolve(service);
    if (!name.ok()) return name.status();
    auto impl = detail::make_client(
        participant, detail::endpoint_spec<Request>(dds_request_topic_name(*name), qos, 0),
        detail::endpoint_spec<Response>(dds_reply_topic_name(*name), qos, 0));
    if (!impl.ok()) return impl.status();
    return ServiceClient(*std::move(name), std::move(impl).value());
  }

  /// Whether a server is there, or came before the time was over.
  bool wait_for_service(std::chrono::milliseconds timeout) const {
    return detail::client_wait(*impl_, timeout);
  }

  /// Sends a request and waits for its reply. The time includes waiting for a server: `unavailable`
  /// when none came, `timeout` when no answer did, `corrupt` when the answer cannot be read.
  Result<Response> call(const Request& request, std::chrono::milliseconds timeout) const {
    auto bytes = detail::client_call(*impl_, detail::message_ref(request), timeout);
    if (!bytes.ok()) return bytes.status();
    Response response;
    Status status = decode(bytes->data(), bytes->size(), response);
    if (!status.ok()) return status;
    return response;
  }

  /// The resolved name.
  const std::string& name() const { return name_; }

 private:
  ServiceClient(std::string name, std::shared_ptr<detail::ServiceClientImpl> impl)
      : name_(std::move(name)), impl_(std::move(impl)) {}

  std::string name_;
  std::shared_ptr<detail::ServiceClientImpl> impl_;
};

}  // namespace bpa::wire
