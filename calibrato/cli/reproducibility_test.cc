// Same seed, same bytes: of the program itself, for any number of threads, and whatever interrupts
// it. Only timing.json may differ.

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <optional>
#include <random>
#include <string>
#include <thread>
#include <vector>

#include "calibrato/base/full_sample_for_test.h"
#include "calibrato/cli/program_for_test.h"

namespace calibrato {
namespace {

constexpr int kInterrupted = 130;

using Files = std::map<std::string, std::string>;

// What must be the same. A program that is killed can't remove the temporary file that it was
// writing, so these are left out.
Files ResultFiles(const std::string& folder) {
  Files files = FilesBelow(folder);
  files.erase("timing.json");
  std::erase_if(files,
                [](const auto& file) { return file.first.find(".tmp-") != std::string::npos; });
  return files;
}

void ExpectSameFiles(const Files& expected, const Files& found) {
  for (const auto& [name, content] : expected) {
    const auto other = found.find(name);
    if (other == found.end()) {
      ADD_FAILURE() << name << " is missing";
      continue;
    }
    // Not EXPECT_EQ: the files have megabytes.
    const auto [mine, theirs] =
        std::mismatch(content.begin(), content.end(), other->second.begin(), other->second.end());
    EXPECT_TRUE(content == other->second)
        << name << " differs from byte " << mine - content.begin() << " on; " << content.size()
        << " and " << other->second.size() << " bytes";
  }
  for (const auto& [name, content] : found) {
    EXPECT_TRUE(expected.count(name)) << name << " is there too much";
  }
}

Files FilesOfRun(Arguments arguments, const std::string& out) {
  arguments.insert(arguments.end(), {"--out", out});
  const Ended ended = RunProgram(arguments);
  EXPECT_EQ(ended.exit_code, 0) << ended.err;
  return ResultFiles(out);
}

// Checkpoints come after every episode; tests of the policy add lines to the log.
Arguments LearnArguments() {
  return {"learn", "intrinsic", "--preset", "paper", "--episodes", "8", "--seed", "3"};
}

Arguments WithThreads(Arguments arguments, int threads) {
  arguments.insert(arguments.end(), {"--threads", std::to_string(threads)});
  return arguments;
}

const Files& LearnedWithoutInterruption() {
  static const Files files = [] {
    const ScratchFolder scratch;
    return FilesOfRun(WithThreads(LearnArguments(), 2), scratch.Path("out"));
  }();
  return files;
}

// Starts learning, or goes on with it if there is a checkpoint.
Arguments LearnOrResume(const std::string& out) {
  Arguments arguments = LearnArguments();
  arguments.insert(arguments.end(), {"--out", out});
  if (std::filesystem::exists(out + "/checkpoint.bin")) arguments.emplace_back("--resume");
  return arguments;
}

// Until training.jsonl has this many lines, or the program has ended.
void WaitForLines(const RunningProgram& program, const std::string& out, std::ptrdiff_t lines) {
  const auto count = [&] {
    const std::string log = ContentOf(out + "/training.jsonl");
    return std::count(log.begin(), log.end(), '\n');
  };
  while (program.IsRunning() && count() < lines) {
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
}

TEST(Learn, WritesTheSameBytesAgainAndForAnyNumberOfThreads) {
  const ScratchFolder scratch;
  const Files& two_threads = LearnedWithoutInterruption();
  for (const char* name : {"checkpoint.bin", "plots.json", "policy/motion.yaml",
                           "policy/policy.bin", "report.html", "result.json", "training.jsonl"}) {
    EXPECT_TRUE(two_threads.count(name)) << name;
  }
  {
    SCOPED_TRACE("again");
    ExpectSameFiles(two_threads,
                    FilesOfRun(WithThreads(LearnArguments(), 2), scratch.Path("again")));
  }
  {
    SCOPED_TRACE("one thread");
    ExpectSameFiles(two_threads, FilesOfRun(WithThreads(LearnArguments(), 1), scratch.Path("one")));
  }
}

// Two stages, the second with calibrations, in rounds; killed in each, the program goes on.
TEST(Learn, OfTheExtrinsicTaskWritesTheSameBytesForAnyNumberOfThreadsAndWhenKilled) {
  const ScratchFolder scratch;
  const Arguments learn = {"learn", "extrinsic", "--preset", "paper",  "--episodes",
                           "5",     "--round",   "2",        "--seed", "3"};
  const Files two_threads = FilesOfRun(WithThreads(learn, 2), scratch.Path("two"));
  for (const char* name : {"policy/motion.yaml", "policy-learned/motion.yaml"}) {
    EXPECT_TRUE(two_threads.count(name)) << name;
  }
  ExpectSameFiles(two_threads, FilesOfRun(WithThreads(learn, 1), scratch.Path("one")));
  const std::string out = scratch.Path("killed");
  const auto learn_or_resume = [&] {
    Arguments arguments = WithThreads(learn, 2);
    arguments.insert(arguments.end(), {"--out", out});
    if (std::filesystem::exists(out + "/checkpoint.bin")) arguments.emplace_back("--resume");
    return arguments;
  };
  for (const std::ptrdiff_t lines : {2, 5}) {
    RunningProgram program(learn_or_resume());
    WaitForLines(program, out, lines);
    program.Signal(SIGKILL);
    (void)program.Wait();
  }
  EXPECT_EQ(RunProgram(learn_or_resume()).exit_code, 0);
  ExpectSameFiles(two_threads, ResultFiles(out));
}

TEST(Learn, WritesOtherBytesForAnotherSeed) {
  const ScratchFolder scratch;
  const Arguments seed_1 = {"learn",      "intrinsic", "--preset", "paper",
                            "--episodes", "2",         "--seed",   "1"};
  const Arguments seed_2 = {"learn",      "intrinsic", "--preset", "paper",
                            "--episodes", "2",         "--seed",   "2"};
  EXPECT_NE(FilesOfRun(seed_1, scratch.Path("1")).at("training.jsonl"),
            FilesOfRun(seed_2, scratch.Path("2")).at("training.jsonl"));
}

TEST(Learn, KilledAtAnyMomentAndResumedWritesTheBytesOfARunThatNeverStopped) {
  const ScratchFolder scratch;
  const std::string out = scratch.Path("out");
  std::mt19937 moments(1);
  std::uniform_int_distribution<int> delay_ms(0, 300);
  // The start-up (maybe before anything is written), the first episodes, and twice after the first
  // checkpoint, so that a resumed run is killed as well; the full sample at 20 moments.
  std::vector<std::ptrdiff_t> all_lines = {0, 2, 8, 9};
  if (FullSample()) {
    all_lines.clear();
    for (std::ptrdiff_t k = 0; k < 20; ++k) all_lines.push_back(k / 2);
  }
  for (const std::ptrdiff_t lines : all_lines) {
    RunningProgram program(LearnOrResume(out));
    WaitForLines(program, out, lines);
    std::this_thread::sleep_for(std::chrono::milliseconds(delay_ms(moments)));
    program.Signal(SIGKILL);
    const Ended ended = program.Wait();
    EXPECT_TRUE(ended.signal == SIGKILL || ended.exit_code == 0)
        << lines << " lines: " << ended.exit_code << " " << ended.err;
    const bool is_done = std::filesystem::exists(out + "/result.json");
    EXPECT_TRUE(is_done || ended.exit_code != 0);
  }
  EXPECT_TRUE(std::filesystem::exists(out + "/checkpoint.bin"));
  const Ended ended = RunProgram(LearnOrResume(out));
  EXPECT_EQ(ended.exit_code, 0) << ended.err;
  ExpectSameFiles(LearnedWithoutInterruption(), ResultFiles(out));
}

TEST(Learn, InterruptedSavesItsStateAndResumedWritesTheBytesOfARunThatNeverStopped) {
  const ScratchFolder scratch;
  const std::string out = scratch.Path("out");
  {
    RunningProgram program(LearnOrResume(out));
    WaitForLines(program, out, 4);
    program.Signal(SIGINT);
    const Ended ended = program.Wait();
    EXPECT_EQ(ended.exit_code, kInterrupted);
    EXPECT_EQ(ended.out, "");
    EXPECT_PRED_FORMAT2(testing::IsSubstring, "--resume", ended.err);
  }
  EXPECT_FALSE(std::filesystem::exists(out + "/result.json"));
  const std::string log = ContentOf(out + "/training.jsonl");
  EXPECT_GE(std::count(log.begin(), log.end(), '\n'), 4);
  const Ended ended = RunProgram(LearnOrResume(out));
  EXPECT_EQ(ended.exit_code, 0) << ended.err;
  ExpectSameFiles(LearnedWithoutInterruption(), ResultFiles(out));
}

// Preset best: a design, then rounds of eight episodes.
Arguments BestArguments(const std::string& out) {
  Arguments arguments = {"learn", "extrinsic", "--believed", "0",     "--episodes",
                         "24",    "--seed",    "3",          "--out", out};
  if (std::filesystem::exists(out + "/checkpoint.json")) arguments.emplace_back("--resume");
  return arguments;
}

TEST(Learn, OfPresetBestKilledAtAnyMomentAndResumedWritesTheBytesOfARunThatNeverStopped) {
  const ScratchFolder scratch;
  const std::string whole = scratch.Path("whole");
  EXPECT_EQ(RunProgram(WithThreads(BestArguments(whole), 1)).exit_code, 0);
  const std::string out = scratch.Path("out");
  std::mt19937 moments(1);
  std::uniform_int_distribution<int> delay_ms(0, 1500);
  // During the first design, and after the first round. The running round is lost each time, so
  // that a moment later than the round takes ends the run.
  std::vector<std::ptrdiff_t> all_lines = {0, 8};
  if (FullSample())
    all_lines.assign({0, 0, 0, 0, 0, 0, 0, 0, 8, 8, 8, 8, 8, 8, 16, 16, 16, 16, 16, 16});
  for (const std::ptrdiff_t lines : all_lines) {
    RunningProgram program(WithThreads(BestArguments(out), 2));
    WaitForLines(program, out, lines);
    std::this_thread::sleep_for(std::chrono::milliseconds(delay_ms(moments)));
    program.Signal(SIGKILL);
    const Ended ended = program.Wait();
    EXPECT_TRUE(ended.signal == SIGKILL || ended.exit_code == 0) << ended.err;
  }
  EXPECT_EQ(RunProgram(WithThreads(BestArguments(out), 2)).exit_code, 0);
  ExpectSameFiles(ResultFiles(whole), ResultFiles(out));
}

// mpirun, where it is; it refuses root unless told otherwise, and more processes than cores.
std::optional<Arguments> Mpirun(int num_processes) {
  if (std::system("mpirun --version >/dev/null 2>&1") != 0) return std::nullopt;
  setenv("OMPI_ALLOW_RUN_AS_ROOT", "1", 1);
  setenv("OMPI_ALLOW_RUN_AS_ROOT_CONFIRM", "1", 1);
  return Arguments{"mpirun", "--oversubscribe", "-n", std::to_string(num_processes)};
}

Arguments InRounds(const std::string& out) {
  Arguments arguments = LearnArguments();
  arguments.insert(arguments.end(), {"--round", "3", "--out", out});
  if (std::filesystem::exists(out + "/checkpoint.bin")) arguments.emplace_back("--resume");
  return arguments;
}

TEST(Learn, InTwoProcessesWritesTheBytesOfOne) {
  const auto mpirun = Mpirun(2);
  if (!mpirun) GTEST_SKIP() << "needs mpirun (openmpi-bin)";
  const ScratchFolder scratch;
  const std::string alone = scratch.Path("alone");
  EXPECT_EQ(RunProgram(InRounds(alone)).exit_code, 0);
  const std::string together = scratch.Path("together");
  const Ended ended = RunningProgram(InRounds(together), std::nullopt, *mpirun).Wait();
  EXPECT_EQ(ended.exit_code, 0) << ended.err;
  // One process speaks.
  EXPECT_NE(ended.out.find("episodes"), std::string::npos) << ended.out;
  EXPECT_EQ(ended.out.find("episodes"), ended.out.rfind("episodes")) << ended.out;
  ExpectSameFiles(ResultFiles(alone), ResultFiles(together));

  // A worker that is lost ends them all; one process goes on.
  const std::string lost = scratch.Path("lost");
  {
    RunningProgram program(InRounds(lost), std::nullopt, *mpirun);
    WaitForLines(program, lost, 3);
    const std::vector<pid_t> workers = program.Children();
    ASSERT_EQ(workers.size(), 2U);
    kill(workers.back(), SIGKILL);
    EXPECT_NE(program.Wait().exit_code, 0);
  }
  EXPECT_FALSE(std::filesystem::exists(lost + "/result.json"));
  EXPECT_EQ(RunProgram(InRounds(lost)).exit_code, 0);
  ExpectSameFiles(ResultFiles(alone), ResultFiles(lost));
}

TEST(Learn, OfPresetBestInTwoProcessesWritesTheBytesOfOne) {
  const auto mpirun = Mpirun(2);
  if (!mpirun) GTEST_SKIP() << "needs mpirun (openmpi-bin)";
  const ScratchFolder scratch;
  const std::string alone = scratch.Path("alone");
  EXPECT_EQ(RunProgram(BestArguments(alone)).exit_code, 0);
  const std::string together = scratch.Path("together");
  const Ended ended = RunningProgram(BestArguments(together), std::nullopt, *mpirun).Wait();
  EXPECT_EQ(ended.exit_code, 0) << ended.err;
  ExpectSameFiles(ResultFiles(alone), ResultFiles(together));
}

TEST(Evaluate, WritesTheSameBytesAgainAndForAnyNumberOfThreads) {
  const ScratchFolder scratch;
  const Arguments evaluate = {"evaluate", "table1", "--num-rigs", "2", "--seed", "3"};
  const Files one_thread = FilesOfRun(WithThreads(evaluate, 1), scratch.Path("one"));
  EXPECT_TRUE(one_thread.count("table1.json"));
  EXPECT_TRUE(one_thread.count("trials.csv"));
  ExpectSameFiles(one_thread, FilesOfRun(WithThreads(evaluate, 2), scratch.Path("two")));
}

TEST(Simulate, WritesTheSameBytesAgainAndCalibratesToTheSameBytes) {
  const ScratchFolder scratch;
  const std::string rig = scratch.Write("rig.yaml", RigYaml());
  const std::string motion = scratch.Write("motion.yaml", MotionYaml(0.1));
  const Arguments simulate = {"simulate", "--rig", rig, "--motion", motion, "--seed"};
  const auto with_seed = [&](const std::string& seed) {
    Arguments arguments = simulate;
    arguments.push_back(seed);
    return arguments;
  };
  const std::string recording = scratch.Path("recording");
  const Files first = FilesOfRun(with_seed("3"), recording);
  EXPECT_TRUE(first.count("cam0_corners.csv"));
  ExpectSameFiles(first, FilesOfRun(with_seed("3"), scratch.Path("again")));
  EXPECT_NE(first.at("cam0_corners.csv"),
            FilesOfRun(with_seed("4"), scratch.Path("other")).at("cam0_corners.csv"));

  const Arguments calibrate = {"calibrate", "camera", recording};
  const Files one_thread = FilesOfRun(WithThreads(calibrate, 1), scratch.Path("one"));
  EXPECT_TRUE(one_thread.count("camchain.yaml"));
  ExpectSameFiles(one_thread, FilesOfRun(WithThreads(calibrate, 2), scratch.Path("two")));
}

}  // namespace
}  // namespace calibrato
