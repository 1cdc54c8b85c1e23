// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
// Compiled, not run: what users of the SDK may include is C++17.
#include "idl/wire/messages.hpp"
#include "idl/wire/publisher.hpp"
#include "idl/wire/service.hpp"
#include "idl/wire/subscriber.hpp"

static_assert(__cplusplus == 201703L, "the wire's headers are for C++17");

template class bpa::wire::Publisher<bpa::wire::bpa_msgs::RgbdFrame>;
template class bpa::wire::Subscriber<bpa::wire::bpa_msgs::SceneInterpretations>;
template class bpa::wire::ServiceServer<bpa::wire::bpa_msgs::Detect>;
template class bpa::wire::ServiceClient<bpa::wire::bpa_msgs::Detect>;
