#pragma once

#include <cerrno>
#include <memory>

#include <gtest/gtest.h>
#include <modbus/modbus.h>

#include "hil/plc/plc_server.h"

// The client of libmodbus, connected to a simulated PLC.

namespace osteon::hil {

/// Closes the connection and frees the context of libmodbus.
struct FreeContext {
  void operator()(modbus_t* context) const {
    modbus_close(context);
    modbus_free(context);
  }
};
using Context = std::unique_ptr<modbus_t, FreeContext>;

/// A connected client; a failure to connect fails the test.
/// @param timeout_ms  time limit for a whole answer
inline Context Connect(const PlcServer& server, unsigned timeout_ms = 5000) {
  Context context(modbus_new_tcp("127.0.0.1", server.port()));
  modbus_set_response_timeout(context.get(), timeout_ms / 1000, timeout_ms % 1000 * 1000);
  EXPECT_EQ(modbus_connect(context.get()), 0) << modbus_strerror(errno);
  return context;
}

}  // namespace osteon::hil
