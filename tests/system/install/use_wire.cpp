// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include <iostream>
#include <string>

#include "idl/wire/names.hpp"

int main() {
  const std::string name = bpa::wire::dds_request_topic_name("/bpa/detect");
  std::cout << name << '\n';
  return name == "rq/bpa/detectRequest" ? 0 : 1;
}
