#include "tests/app/docs_commands.h"

#include <map>
#include <sstream>

#include "tests/app/command.h"
#include "tests/io/temporary_folder.h"
#include "tests/simulation/mesh/mesh_shapes.h"

namespace osteon::app {
namespace {

using io::test::ReadAll, io::test::WriteAll;

std::vector<std::string> Words(const std::string& text) {
  std::istringstream words(text);
  std::vector<std::string> all;
  for (std::string word; words >> word;) all.push_back(word);
  return all;
}

// Runs the command with other arguments, which usually shorten the run. `leaves` names the files that the run
// must write.
DocRun RunAs(const std::string& arguments, std::vector<std::string> leaves = {}) {
  return {.arguments = Words(arguments), .leaves = std::move(leaves), .elsewhere = ""};
}
// Does not run the command here, because the test "Suite.Name" runs it.
DocRun TestedBy(const std::string& test) { return {.arguments = {}, .leaves = {}, .elsewhere = test}; }

// Writes torn.mcap, the first half of the demo's recording. A run that is killed leaves such a file.
void Tear(const std::filesystem::path& folder) {
  const std::string whole = ReadAll(folder / "demo_out/recording.mcap");
  WriteAll(folder / "torn.mcap", whole.substr(0, whole.size() / 2));
}

// Writes torn.mcap, then recovers it.
DocRun Torn() {
  DocRun run = RunAs("export torn.mcap --recover", {"torn_recovered.mcap"});
  run.before = Tear;
  return run;
}

// Runs with the tutorial's cell: the demo's cell with another force limit.
DocRun OwnCell() {
  DocRun run = RunAs("demo --virtual-time --seconds 0.5 --cell my_cell.yaml --tool reamer:54 --out my_out",
                     {"my_out/report.html"});
  run.before = [](const std::filesystem::path& folder) {
    WriteAll(folder / "my_cell.yaml", "extends: demo\nlimits: {max_force_N: 80}\n");
  };
  return run;
}

// Runs a command of the tuning page's example, after the example's earlier commands: the measurement, and if
// `from_recording` is true also the identification from the measurement's recordings.
DocRun Tuned(const std::string& arguments, std::vector<std::string> leaves, bool from_recording) {
  DocRun run = RunAs(arguments, std::move(leaves));
  run.before = [from_recording](const std::filesystem::path& folder) {
    RunCommand(folder, Words("identify demo --simulated --do free,validate --axes z --speeds 50"));
    if (from_recording)
      RunCommand(folder, Words("identify demo --recording identify/free_z_50.mcap --validate "
                               "identify/validate_z_50.mcap --out measured"));
  };
  return run;
}

// For each command, by its text on the page, how to run it.
const std::map<std::string, DocRun>& Runs() {
  static const std::map<std::string, DocRun> runs{
      {"osteon demo", RunAs("demo --virtual-time --seconds 0.5", {"demo_out/report.html"})},
      {"osteon demo --virtual-time", RunAs("demo --virtual-time --seconds 0.5", {"demo_out/report.html"})},
      {"osteon demo --seconds 60", RunAs("demo --virtual-time --seconds 0.5", {"demo_out/report.html"})},
      {"osteon bench console --chromium /usr/bin/chromium",
       TestedBy("BenchConsole.MeasuresEveryLegAndItsRatios")},
      {"osteon bench console --reloads 1000", TestedBy("BenchConsole.AHundredReloadsLeaveNoResourceBehind")},
      {"osteon status", TestedBy("OperatorCommands.PauseResumeAndStopARunningCell")},
      {"osteon pause", TestedBy("OperatorCommands.PauseResumeAndStopARunningCell")},
      {"osteon recover", TestedBy("OperatorCommands.PauseResumeAndStopARunningCell")},
      {"osteon resume", TestedBy("OperatorCommands.PauseResumeAndStopARunningCell")},
      {"osteon stop", TestedBy("OperatorCommands.PauseResumeAndStopARunningCell")},
      {"osteon view demo_out/recording.mcap", TestedBy("OperatorCommands.ViewServesARecordingUntilCtrlC")},
      {"osteon view before.mcap after.mcap",
       TestedBy("RecordingDifferenceTest.RunsThatDifferOnlyInTheirStartTimeShowNoDifference")},
      {"osteon bench view demo_out/recording.mcap --hours 1",
       TestedBy("BenchView.OpensARepeatedRecordingAndSeeksInIt")},
      {"osteon demo --virtual-time --cell my_cell.yaml --tool reamer:54 --out my_out", OwnCell()},
      {"osteon demo --virtual-time --cell silent.yaml --out silent_out",
       TestedBy("Regress.AllShippedScenariosPass")},  // in the scenario sensor_silent

      {"osteon bench frame --spheres 300000 --tool-spheres 1000 --compare brute --frames 50",
       RunAs("bench frame --spheres 20000 --tool-spheres 20 --compare brute --frames 20")},
      {"osteon bench frame --engines cpu,vulkan --rounds 5 --json engines.json",
       TestedBy("BenchFrame.TimesEnginesOnNamedWorkloadsInRounds")},
      {"osteon bench frame --method cpu --compare --rounds 3 --json voxels.json",
       TestedBy("BenchFrame.ComparesWithPlainVoxels")},
      {"osteon bench kinematics", RunAs("bench kinematics --calls 1000")},
      {"osteon bench kinematics --robot config/robots/kr_6_r900_2.yaml --json kr.json",
       RunAs("bench kinematics --robot config/robots/kr_6_r900_2.yaml --json kr.json --calls 1000",
             {"kr.json"})},
      {"osteon capability config/cells/demo.yaml",
       RunAs("capability config/cells/demo.yaml --nodes 11 --no-search", {"capability/capability.html"})},
      {"osteon chart scaling --out scaling", TestedBy("ChartScaling.WritesItsFilesAndPoints")},
      {"osteon chart compliance", TestedBy("ChartCompliance.WritesItsFilesAndFigures")},
      {"osteon bench tick --compliance --ticks 2000", TestedBy("BenchTick.TimesEachComplianceLevel")},
      {"osteon chart speed-accuracy --out speed_accuracy",
       TestedBy("ChartSpeedAccuracy.WritesItsFilesAndPoints")},
      {"osteon failures --out failures",
       RunAs("failures 2 --quick --out failures", {"failures/failures.html"})},
      {"osteon validate --json validate.json --out validate",
       RunAs("validate --quick --rows 9 --json validate.json --out validate",
             {"validate.json", "validate/validate.html", "validate/validate.svg"})},
      {"osteon soak --hours 8 --out soak --json soak.json",
       RunAs("soak --hours 0.001 --out soak --json soak.json", {"soak.json", "soak/soak.html"})},
      {"osteon soak --wall --hours 2 --out soak_wall --json soak_wall.json",
       TestedBy("SoakWall.RunsTheCellsProcessesAndReportsTheirFigures")},
      {"osteon transparency demo", RunAs("transparency demo --points 3", {"transparency/transparency.html"})},
      {"osteon tune config/cells/demo.yaml",
       RunAs("tune config/cells/demo.yaml --nodes 4", {"tune/tune.html", "tune/gains.yaml"})},
      {"osteon tune my_cell.yaml --identified identify/identified.yaml",
       TestedBy("Tune.UsesMeasuredFiguresAndRefusesThoseOfAnotherCell")},
      {"osteon run demo --simulated --seconds 10 --gains tune/gains.yaml",
       TestedBy("GainsRun.GoodGainsSavedDuringARunActBadOnesDoNotAndTheRunReplaysBitForBit")},

      {"osteon assess session_1", TestedBy("Assess.WritesPageAndResultAndExitsByTheScore")},
      {"osteon assess session_1 --pass-at 70 --norms expert_1 expert_2",
       TestedBy("Assess.ASessionAsItsOwnNormGivesItsFiguresAsMedians")},
      {"osteon surgical-plan acetabulum", RunAs("surgical-plan acetabulum")},
      {"osteon surgical-plan hip_bone_left --mesh hip_bone_left.obj",
       TestedBy("HipBonePlan.IsReamedAssessedAndReplayed")},
      {"osteon surgical-plan molar --cell molar", RunAs("surgical-plan molar --cell molar")},
      {"osteon demo --cell molar --plan molar --virtual-time --out dentist",
       TestedBy("MolarPlan.IsOpenedAssessedAndReplayed")},
      {"osteon demo --cell molar --plan molar --virtual-time --operator novice --out student",
       TestedBy("MolarPlan.IsOpenedAssessedAndReplayed")},
      {"osteon assess dentist/session --against student/session",
       TestedBy("MolarPlan.IsOpenedAssessedAndReplayed")},
      {"osteon demo --plan hip_bone_left --mesh hip_bone_left.obj --virtual-time",
       TestedBy("HipBonePlan.IsReamedAssessedAndReplayed")},
      {"osteon run demo --simulated --plan acetabulum --session anna/4 --gain-from anna --seconds 60",
       TestedBy("GainFrom.EachPassedSessionOfThePlanReducesTheGainByAQuarter")},
      {"osteon report demo_out/session/run_1.mcap",
       TestedBy("KilledDemo.ResumesAtItsLastPassAndIsAssessedReportedAndExported")},
      {"osteon export demo_out/session/run_1.mcap --csv --surface bone.stl",
       TestedBy("KilledDemo.ResumesAtItsLastPassAndIsAssessedReportedAndExported")},
      {"osteon tune demo --plan acetabulum", RunAs("tune demo --plan acetabulum --nodes 3")},
      {"osteon surgical-plan acetabulum --cell demo --json plan.json",
       RunAs("surgical-plan acetabulum --cell demo --json plan.json", {"plan.json"})},
      {"osteon plan acetabulum --error-mm 0.1 --rate-hz 1000",
       TestedBy("Plan.WritesTheDocumentedKeysAndKeepsThePredictedError")},
      {"osteon plan sawbone_block --error-mm 0.05 --rate-hz 1000",
       RunAs("plan sawbone_block --error-mm 0.05 --rate-hz 1000")},
      {"osteon demo --cell pelvis_mount --virtual-time",
       RunAs("demo --cell pelvis_mount --virtual-time --seconds 0.5", {"demo_out/report.html"})},
      {"osteon demo --cell long_drill --virtual-time",
       RunAs("demo --cell long_drill --virtual-time --seconds 0.5", {"demo_out/report.html"})},
      {"osteon demo --cell femoral_long_drill --virtual-time",
       RunAs("demo --cell femoral_long_drill --virtual-time --seconds 0.5", {"demo_out/report.html"})},
      {"osteon demo --cell soft_cup --virtual-time",
       RunAs("demo --cell soft_cup --virtual-time --seconds 0.5", {"demo_out/report.html"})},
      {"osteon plan molar --error-mm 0.02 --rate-hz 1000 --check --json plan.json",
       TestedBy("Plan.WritesTheDocumentedKeysAndKeepsThePredictedError")},
      {"osteon run demo --simulated --seconds 25 --rate-hz 1200",
       TestedBy("GuardProcess.ARunOfASimulatedCellStartsAndEndsItsGuard")},
      {"osteon regress --junit regress.xml", TestedBy("Regress.AllShippedScenariosPass")},
      {"osteon regress scenarios --junit regress.xml --json regress.json",
       TestedBy("Regress.AllShippedScenariosPass")},
      {"osteon regress reaming_lbr --update --reason \"the reamer's mass was weighed anew\"",
       TestedBy("Regress.AChangeIsAcceptedWithAReason")},

      {"osteon regress --shard 1/2 --json part_1.json", TestedBy("Merge.MergedRegressEqualsOneRun")},
      {"osteon regress --shard 2/2 --json part_2.json", TestedBy("Merge.MergedRegressEqualsOneRun")},
      {"osteon merge part_1.json part_2.json --json regress.json",
       TestedBy("Merge.MergedRegressEqualsOneRun")},
      {"osteon merge part_*.json --json sweep.json", TestedBy("Merge.MergedSweepEqualsOneRun")},
      {"osteon regress --sweep trembling_hand --json sweep.json", TestedBy("Merge.MergedSweepEqualsOneRun")},
      {"osteon regress --sweep trembling_hand --shard {}/64 --json part_{}.json ::: $(seq 64)",
       TestedBy("Merge.MergedSweepEqualsOneRun")},
      {"osteon demo --plan acetabulum --virtual-time",
       TestedBy("ProcedureRun.EachReamerLeavesAPassAndAState")},
      {"osteon demo --plan acetabulum --virtual-time --out expert",
       TestedBy("NoviceAndExpert.DifferInScoreAxisAndForce")},
      {"osteon demo --plan acetabulum --virtual-time --operator novice --out novice",
       TestedBy("NoviceAndExpert.DifferInScoreAxisAndForce")},
      {"osteon assess expert/session --against novice/session",
       TestedBy("Assess.ComparesASecondSessionOfTheSamePlanOnly")},
      {"osteon run demo --simulated --plan acetabulum --session first_hip --seconds 60",
       TestedBy("ProcedureRun.EachReamerLeavesAPassAndAState")},
      {"osteon tell first_hip status", TestedBy("SessionRequest.AcceptsOnlyTheKnownRequests")},
      {"osteon cell demo --plan acetabulum --seconds 120",
       TestedBy("CellProcess.AThirdProcessChangesThePlansToolDuringARun")},
      {"osteon run demo --plan acetabulum --session second_hip --seconds 120",
       TestedBy("CellProcess.AThirdProcessChangesThePlansToolDuringARun")},
      {"osteon tell second_hip pause", TestedBy("CellProcess.AThirdProcessChangesThePlansToolDuringARun")},
      {"osteon tell second_hip next", TestedBy("CellProcess.AThirdProcessChangesThePlansToolDuringARun")},
      {"osteon tell second_hip resume", TestedBy("CellProcess.AThirdProcessChangesThePlansToolDuringARun")},
      {"osteon replay demo_out/session", TestedBy("ProcedureRun.TheLoopReplaysBitForBitWithItsToolTable")},

      {"osteon new-cell my_cell", RunAs("new-cell my_cell", {"my_cell.yaml"})},
      {"osteon doctor", RunAs("doctor --seconds 0.2")},
      {"osteon doctor demo", TestedBy("Doctor.SaysThatASimulatedCellsConnectionsAreSimulated")},
      {"osteon doctor my_cell.yaml", TestedBy("Doctor.NamesEachMissingConnectionOfARealCell")},
      {"osteon cell demo", TestedBy("CellProcess.ARunConnectsToACellInAnotherProcess")},
      {"osteon run demo", TestedBy("CellProcess.ARunConnectsToACellInAnotherProcess")},
      {"osteon cell my_cell.yaml", TestedBy("GuardProcess.ARunThroughTheGuardCompletes")},
      {"osteon guard my_cell.yaml", TestedBy("GuardProcess.ARunThroughTheGuardCompletes")},
      {"osteon guard my_cell.yaml --json guard.json", TestedBy("GuardProcess.ARunThroughTheGuardCompletes")},
      {"osteon demo --cell my_cell.yaml", TestedBy("EngineProcess.CarvesWhatAThreadCarvesBitForBit")},
      {"osteon simulate", TestedBy("EngineInLockstep.CarvesTheSameOverUdp")},
      {"osteon simulate --listen 192.168.1.7:30300 --token-file engine_token.txt",
       TestedBy("EngineInLockstep.ListensBeyondTheLoopbackOnlyWithAToken")},
      {"osteon bench simulate --ticks 3000 --json simulate.json",
       TestedBy("BenchSimulate.TimesEachWayToRunTheEngine")},
      {"osteon run my_cell.yaml --seconds 10", TestedBy("GuardProcess.ARunThroughTheGuardCompletes")},
      {"osteon run my_cell.yaml --simulated --seconds 5",
       TestedBy("GuardProcess.ARunOfASimulatedCellStartsAndEndsItsGuard")},
      {"osteon run my_cell.yaml", TestedBy("CellProcess.ARunConnectsToACellInAnotherProcess")},
      {"osteon identify demo --simulated --do joints --joints 1,4,7",
       TestedBy("IdentifyCommand.FindsTheSameForEachJointInARunAndInItsRecording")},
      {"osteon identify demo --simulated --do noise,free --axes z --speeds 50",
       RunAs("identify demo --simulated --do noise,free --axes z --speeds 50", {"identify/identified.yaml"})},
      {"osteon capability demo --identified identify/identified.yaml",
       RunAs("capability demo --identified identify/identified.yaml --nodes 5 --no-search",
             {"capability/capability.html"})},
      {"osteon identify demo --simulated --axes z --speeds 50",
       RunAs("identify demo --simulated --do free --axes z --speeds 50", {"identify/identified.yaml"})},
      {"osteon identify demo --simulated --do free,validate --axes z --speeds 50",
       RunAs("identify demo --simulated --do free,validate --axes z --speeds 50",
             {"identify/free_z_50.mcap", "identify/validate_z_50.mcap"})},
      {"osteon identify demo --recording identify/free_z_50.mcap --validate identify/validate_z_50.mcap "
       "--out measured",
       Tuned("identify demo --recording identify/free_z_50.mcap --validate identify/validate_z_50.mcap "
             "--out measured",
             {"measured/identified.yaml"}, false)},
      {"osteon tune demo --identified measured/identified.yaml --out tune_measured",
       Tuned("tune demo --identified measured/identified.yaml --out tune_measured --nodes 4",
             {"tune_measured/tune.html", "tune_measured/gains.yaml"}, true)},
      {"osteon identify my_cell.yaml --axes x,y,z --speeds 10,50 --out identify",
       TestedBy("ExcitedRun.IdentifiesTheSimulatedArmAndItsSensor")},
      {"osteon identify my_cell.yaml --recording identify/free_z_50.mcap --validate "
       "identify/validate_z_50.mcap",
       TestedBy("ExcitedRun.IdentifiesTheSimulatedArmAndItsSensor")},
      {"osteon identify demo --simulated --wall-time --do free --axes z --speeds 50",
       TestedBy("ExcitedRun.RecordsACellThatIsConnectedBySockets")},
      {"osteon identify thin_plate_impedance --simulated --do free,validate --axes z --speeds 50",
       TestedBy("ExcitedRun.IdentifiesTheArmsCartesianImpedance")},
      {"osteon identify demo --table 30", TestedBy("IdentifyTable.PredictsTheStabilityLimitsOfTheTrueArm")},
      {"osteon demo --virtual-time --seconds 13 --out long",
       TestedBy("VirtualDemo.WritesSummaryRecordingAndReportThatAgree")},
      {"osteon identify demo --recording long/recording.mcap --out ordinary",
       TestedBy("PassiveLag.IsSeparatedFromTheYieldingToAHandsForce")},
      {"osteon calibrate my_cell.yaml --payload weigh.mcap --pivot tip.mcap --out "
       "config/cells/my_calibration.yaml",
       TestedBy("CalibrateTest.FindsPayloadBiasAndApexAndTheCellUsesThem")},

      {"osteon export demo_out/recording.mcap",
       RunAs("export demo_out/recording.mcap", {"demo_out/recording_ticks.csv"})},
      {"osteon export demo_out/recording.mcap --surface bone.stl --at 4.5",
       RunAs("export demo_out/recording.mcap --surface bone.stl --at 0.5", {"bone.stl"})},
      {"osteon export demo_out/recording.mcap --foxglove with_bone.mcap",
       RunAs("export demo_out/recording.mcap --foxglove with_bone.mcap", {"with_bone.mcap"})},
      {"osteon export torn.mcap --recover", Torn()},
      {"osteon diff before.mcap after.mcap --out compared",
       RunAs("diff demo_out/recording.mcap demo_out/recording.mcap --out compared", {"compared/diff.html"})},
      {"osteon replay demo_out/recording.mcap", RunAs("replay demo_out/recording.mcap")},
      {"osteon export run_2026-11-26_09-30-00.mcap",
       TestedBy("ExportCommandTest.TablesHoldEveryValueBitForBit")},
      {"osteon replay run_2026-11-26_09-30-00.mcap",
       TestedBy("ReplayCommandTest.ReplayIsIdenticalBitForBit")},

      {"osteon pack hip.obj -o hip.osp --report hip_report",
       RunAs("pack hip.obj -o hip.osp --report hip_report --count 1000 --point-spacing-mm 4",
             {"hip.osp", "hip_report/report.html"})},
      {"osteon pack hip.obj -o hip.osp --cup 8.8,-131.9,517.9,-0.983,-0.175,0.052,21 --count 25000",
       RunAs("pack hip.obj -o hip.osp --cup 0,0,30,0,0,1,24 --count 2500 --point-spacing-mm 1.2",
             {"hip.osp"})},
      {"osteon pack tooth.obj -o tooth.osp --scene molar --count 36000",
       RunAs("pack tooth.obj -o tooth.osp --scene molar --count 3600", {"tooth.osp"})},
      {"osteon pack acetabulum -o acetabulum.osp",
       RunAs("pack acetabulum -o acetabulum.osp", {"acetabulum.osp"})},
      {"osteon pack box:40,40,40 -o box.ply --mode disjoint --count 5000",
       RunAs("pack box:40,40,40 -o box.ply --mode disjoint --count 500", {"box.ply"})},
      {"osteon pack hip.osp -o hip.ply -o hip.csv",
       RunAs("pack hip.osp -o hip.ply -o hip.csv", {"hip.ply", "hip.csv"})},
      {"osteon demo --mesh hip.osp", RunAs("demo --mesh hip.osp --virtual-time --seconds 0.3")},

      {"osteon demo --cell molar --tool round_burr:1.6 --virtual-time",
       TestedBy("Docs.DiffBlocksApplyToTheTreeAndTheChangedCellsRun")},
      {"osteon demo --cell sawbone_block --virtual-time",
       TestedBy("Docs.DiffBlocksApplyToTheTreeAndTheChangedCellsRun")},
      {"osteon demo --mesh hip.obj --cup 8.8,-131.9,517.9,-0.983,-0.175,0.052,21",
       TestedBy("MeshDemo.ReamsTheHipBone")},
  };
  return runs;
}

}  // namespace

std::optional<DocRun> HowToRun(const std::string& command) {
  const auto at = Runs().find(command);
  return at == Runs().end() ? std::nullopt : std::optional(at->second);
}

std::vector<std::string> KnownCommands() {
  std::vector<std::string> all;
  for (const auto& [command, run] : Runs()) all.push_back(command);
  return all;
}

void PutInputs(const std::filesystem::path& root, const std::filesystem::path& folder) {
  std::filesystem::copy(root / "config", folder / "config", std::filesystem::copy_options::recursive);
  const auto box = [](double half_m) {
    return simulation::ObjText(simulation::MakeBox(Vector3::Constant(-half_m), Vector3::Constant(half_m)));
  };
  WriteAll(folder / "hip.obj", box(0.03));
  WriteAll(folder / "tooth.obj", box(0.008));
}

bool IsTest(const std::filesystem::path& root, const std::string& suite_and_name) {
  const std::size_t dot = suite_and_name.find('.');
  const std::string declared =
      "(" + suite_and_name.substr(0, dot) + ", " + suite_and_name.substr(dot + 1) + ")";
  for (const auto& file : std::filesystem::recursive_directory_iterator(root / "tests"))
    if (file.path().extension() == ".cpp" && ReadAll(file.path()).find(declared) != std::string::npos)
      return true;
  return false;
}

}  // namespace osteon::app
