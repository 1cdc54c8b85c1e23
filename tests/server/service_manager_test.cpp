// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "server/service_manager.hpp"

#include <cstdlib>
#include <string>

#include <gtest/gtest.h>
#include <unistd.h>

#include "tests/support/notify_socket.hpp"
#include "tests/support/temporary_folder.hpp"

namespace bpa::server {
namespace {

// What systemd sets; unset again by the next.
void set(const char* name, const std::string& value) { setenv(name, value.c_str(), 1); }

class ServiceManagerTest : public testing::Test {
 protected:
  ~ServiceManagerTest() override {
    for (const char* name : {"NOTIFY_SOCKET", "WATCHDOG_USEC", "WATCHDOG_PID"}) unsetenv(name);
  }
};

TEST_F(ServiceManagerTest, WithoutASocketNothingIsTold) {
  const ServiceManager manager;
  EXPECT_TRUE(manager.tell("READY=1").ok());
  EXPECT_EQ(manager.watchdog_time().count(), 0);
}

TEST_F(ServiceManagerTest, LinesArriveAtThePathAndInTheAbstractNamespace) {
  const test::TemporaryFolder folder;
  for (const std::string& name : {folder.path() + "/notify", "@bpa_test" + folder.path()}) {
    support::NotifySocket socket(name);
    set("NOTIFY_SOCKET", name);
    EXPECT_TRUE(ServiceManager().tell("READY=1\nSTATUS=serving").ok()) << name;
    EXPECT_EQ(socket.receive(), "READY=1\nSTATUS=serving") << name;
  }
}

TEST_F(ServiceManagerTest, ASocketThatNobodyReadsIsAnErrorWithItsName) {
  for (const std::string& name :
       {std::string("/nowhere/notify"), std::string("relative"), '/' + std::string(200, 'x')}) {
    set("NOTIFY_SOCKET", name);
    const Status status = ServiceManager().tell("READY=1");
    EXPECT_FALSE(status.ok()) << name;
    EXPECT_NE(status.message.find(name), std::string::npos) << status.message;
  }
}

TEST_F(ServiceManagerTest, TheWatchdogIsThisProcessesAlone) {
  set("WATCHDOG_USEC", "3000000");
  EXPECT_EQ(ServiceManager().watchdog_time(), std::chrono::seconds(3));
  set("WATCHDOG_PID", std::to_string(getpid()));
  EXPECT_EQ(ServiceManager().watchdog_time(), std::chrono::seconds(3));
  set("WATCHDOG_PID", std::to_string(getppid()));
  EXPECT_EQ(ServiceManager().watchdog_time().count(), 0);
  set("WATCHDOG_PID", "");
  set("WATCHDOG_USEC", "soon");
  EXPECT_EQ(ServiceManager().watchdog_time().count(), 0);
}

}  // namespace
}  // namespace bpa::server
