#include "app/cli/console_option.h"

#include <string>

#include <fmt/format.h>

namespace osteon::app {

void AddConsoleOption(CLI::App& sub, ConsoleChoice& choice) {
  sub.add_option_function<std::string>(
         "--console",
         [&choice](const std::string& text) {
           auto parsed = ConsoleChoice::Parse(text);
           if (!parsed) throw CLI::ValidationError("--console", parsed.error());
           choice = *parsed;
         },
         fmt::format("where the page that shows the cell is served: PORT, ADDRESS:PORT, or off; an address "
                     "other than "
                     "the loopback asks for a token. Without it the first free port from {} on",
                     console::kDefaultPort))
      ->type_name("PORT");
}

}  // namespace osteon::app
