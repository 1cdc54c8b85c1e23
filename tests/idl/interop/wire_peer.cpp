// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
// Our own end in another process: sends back on /out/frame what comes on /in/frame, through shared
// memory, and serves /own/unload_model. Usage: wire_peer DOMAIN; ends when its standard input does.
#include <cstdio>
#include <cstdlib>

#include <unistd.h>

#include "idl/wire/messages.hpp"
#include "idl/wire/publisher.hpp"
#include "idl/wire/service.hpp"
#include "idl/wire/subscriber.hpp"
#include "tests/idl/wire/domain.hpp"

int main(int argc, char** argv) {
  using namespace bpa::wire;
  using Frame = bpa_msgs::RgbdFrame;
  using Unload = bpa_msgs::UnloadModel;
  if (argc != 2) return 2;
  auto participant = test_participant("wire_peer", {}, std::atoi(argv[1]));
  if (!participant.ok()) return 1;
  PublisherOptions publisher_options;
  publisher_options.qos = qos::frames();
  auto publisher = Publisher<Frame>::create(*participant, "/out/frame", publisher_options);
  SubscriberOptions subscriber_options;
  subscriber_options.qos = qos::reliable_input();
  auto subscriber = Subscriber<Frame>::create(
      *participant, "/in/frame", subscriber_options,
      [&publisher](Frame&& frame, const SampleMeta&) { (void)publisher->publish(frame).ok(); });
  auto server =
      ServiceServer<Unload>::create(*participant, "/own/unload_model",
                                    [](Unload::Request&& request, const ReplyToken<Unload>& token) {
                                      Unload::Response response;
                                      response.success = true;
                                      response.status.message = request.name;
                                      (void)token.reply(response).ok();
                                    });
  if (!publisher.ok() || !subscriber.ok() || !server.ok()) return 1;
  while (std::getchar() != EOF) {
  }
  return 0;
}
