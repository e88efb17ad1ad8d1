// Measures sinew-logger: CPU beside an empty reader, what a kill costs, memory over hours.
#include <CLI/CLI.hpp>
#include <iostream>

#include "bench/logger/measures.h"

int main(int argc, char** argv) try {
  using namespace sinew::logger_bench;
  CLI::App app("Measures the logger; exit code 1 when a goal is missed", "logger_bench");
  app.require_subcommand(1);
  const auto folder = std::filesystem::temp_directory_path();
  bool met = true;

  CpuOptions cpu_options;
  cpu_options.folder = folder;
  CLI::App* cpu = app.add_subcommand("cpu", "CPU time beside a reader that does nothing");
  cpu->add_option("--domain", cpu_options.domain_id, "DDS domain")->capture_default_str();
  cpu->add_option("--rate", cpu_options.rate_Hz, "Hz")->check(CLI::PositiveNumber);
  cpu->add_option("--seconds", cpu_options.seconds, "How long")->check(CLI::PositiveNumber);
  cpu->add_option("--folder", cpu_options.folder, "For the recording")
      ->check(CLI::ExistingDirectory);
  cpu->add_option("--compression", cpu_options.compression, "none, lz4 or zstd");
  cpu->callback([&] { met = MeasureCpu(cpu_options); });

  CpuOptions lcm_options = cpu_options;
  CLI::App* lcm = app.add_subcommand("lcm", "CPU time of lcm-logger on the same bytes");
  lcm->add_option("--rate", lcm_options.rate_Hz, "Hz")->check(CLI::PositiveNumber);
  lcm->add_option("--seconds", lcm_options.seconds, "How long")->check(CLI::PositiveNumber);
  lcm->add_option("--folder", lcm_options.folder, "For the logs")->check(CLI::ExistingDirectory);
  lcm->callback([&] { met = MeasureLcm(lcm_options); });

  int reader_domain = 0;
  CLI::App* reader = app.add_subcommand("reader", "The reader that does nothing");
  reader->add_option("--domain", reader_domain, "DDS domain");
  reader->callback([&] { ReadInVain(reader_domain); });

  KillOptions kill_options;
  kill_options.folder = folder;
  CLI::App* kills = app.add_subcommand("kills", "What SIGKILL at any instant costs");
  kills->add_option("--domain", kill_options.domain_id, "DDS domain");
  kills->add_option("--rate", kill_options.rate_Hz, "Hz")->check(CLI::PositiveNumber);
  kills->add_option("--count", kill_options.count, "Kills")->check(CLI::PositiveNumber);
  kills->add_option("--seed", kill_options.seed, "Of the instants");
  kills->add_option("--folder", kill_options.folder, "For the recording")
      ->check(CLI::ExistingDirectory);
  kills->callback([&] { met = MeasureKills(kill_options); });

  HourOptions hour_options;
  CLI::App* hours = app.add_subcommand("hours", "Memory over hours of data");
  hours->add_option("--hours", hour_options.hours, "Of data")->check(CLI::PositiveNumber);
  hours->add_option("--rate", hour_options.rate_Hz, "Hz")->check(CLI::PositiveNumber);
  hours->add_option("--split-hours", hour_options.split_hours, "Length of a file, 0: one file")
      ->check(CLI::NonNegativeNumber);
  hours->callback([&] { met = MeasureHours(hour_options); });

  CLI11_PARSE(app, argc, argv);
  return met ? EXIT_SUCCESS : EXIT_FAILURE;
} catch (const std::exception& error) {
  std::cerr << error.what() << '\n';
  return EXIT_FAILURE;
}
