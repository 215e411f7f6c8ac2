#include <CLI/CLI.hpp>
#include <memory>
#include "core/calibrate/calibrate.h"
#include "server/commands.h"
namespace hermite {
Command add_calibrate_command(CLI::App& app) {
  struct A { std::string sequence, trajectory, frames, camera; std::size_t most = 60; };
  auto a = std::make_shared<A>();
  CLI::App& c = *app.add_subcommand("calibrate", "");
  c.add_option("SEQUENCE", a->sequence)->required();
  c.add_option("--trajectory", a->trajectory);
  c.add_option("--frames", a->frames);
  c.add_option("--most", a->most);
  return {&c, [a] {
    const auto sequence = or_throw(open_sequence(a->sequence));
    return prototype_calibrate(*sequence, or_throw(read_tum_trajectory(a->trajectory)), or_throw(parse_frame_range(a->frames, sequence->frame_count())), a->most);
  }};
}
}
