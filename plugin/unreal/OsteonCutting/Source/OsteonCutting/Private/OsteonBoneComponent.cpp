#include "OsteonBoneComponent.h"

#include <vector>

#include "OsteonConvert.h"
#include "OsteonRefusal.h"
#include "osteon_host_plan.h"

UOsteonBoneComponent::UOsteonBoneComponent(const FObjectInitializer& Initializer) : Super(Initializer) {
  PrimaryComponentTick.bCanEverTick = true;
}

void UOsteonBoneComponent::BeginPlay() {
  Super::BeginPlay();
  Open();
}

void UOsteonBoneComponent::EndPlay(const EEndPlayReason::Type Reason) {
  Close();
  Super::EndPlay(Reason);
}

void UOsteonBoneComponent::TickComponent(float DeltaTime, ELevelTick TickType,
                                         FActorComponentTickFunction* ThisTickFunction) {
  Super::TickComponent(DeltaTime, TickType, ThisTickFunction);
  if (!IsOpen()) return;
  if (Tool) SetToolPose(Tool->GetComponentTransform().GetRelativeTransform(GetComponentTransform()));
  UpdateMesh();
  TellEvents();
}

bool UOsteonBoneComponent::Open() {
  Close();
  const FTCHARToUTF8 SceneText(*Scene), ToolText(*ToolName), FolderText(*ConfigFolder);
  osteon::host::SessionParams Params;
  Params.scene = SceneText.Get();
  Params.tool = ToolText.Get();
  Params.diameter_m = 1e-3 * ToolDiameter_mm;
  Params.config_folder = ConfigFolder.IsEmpty() ? nullptr : FolderText.Get();
  Params.max_force_N = MaxForce_N;
  if (!Succeeds(HostSession.Open(Params))) return false;
  const FString Warning = GetBoneWarning();
  if (!Warning.IsEmpty()) UE_LOG(LogTemp, Warning, TEXT("Osteon: %s"), *Warning);
  return true;
}

FString UOsteonBoneComponent::GetEngine() const {
  return IsOpen() ? UTF8_TO_TCHAR(osteon_session_engine(HostSession.session())) : TEXT("");
}

FString UOsteonBoneComponent::GetBoneWarning() const {
  return UTF8_TO_TCHAR(osteon_bone_warning(HostSession.bone()));
}

FString UOsteonBoneComponent::GetLibraryVersion() { return UTF8_TO_TCHAR(osteon_version()); }

void UOsteonBoneComponent::Close() {
  HostSession.Close();
  ClearAllMeshSections();
  Sections.Empty();
  LastRefusal.Empty();
}

bool UOsteonBoneComponent::SetToolPose(const FTransform& Pose) {
  const double Spindle = bSpins ? HostSession.spindle_rad_per_s() : 0.0;
  return Succeeds(HostSession.SetToolPose(OsteonConvert::ToPose(Pose), Spindle));
}

FVector UOsteonBoneComponent::GetForce(const FTransform& Pose) {
  osteon::host::Wrench Wrench;
  Succeeds(HostSession.Evaluate(OsteonConvert::ToPose(Pose), &Wrench));
  return OsteonConvert::ToVector(Wrench.force_N);
}

bool UOsteonBoneComponent::GetWrench(const FTransform& Pose, const FVector& Velocity,
                                     const FVector& AngularVelocity, FVector& Force_N, FVector& Torque_Nm) {
  osteon::host::Wrench Wrench;
  const bool bGood = Succeeds(HostSession.Evaluate(
      OsteonConvert::ToPose(Pose), OsteonConvert::ToTwist(Velocity, AngularVelocity), &Wrench));
  Force_N = OsteonConvert::ToVector(Wrench.force_N);
  Torque_Nm = OsteonConvert::ToVector(Wrench.torque_Nm);
  return bGood;
}

bool UOsteonBoneComponent::SetCompliance(const FOsteonCompliance& Compliance) {
  OsteonComplianceParams Params;
  if (!Succeeds(HostSession.DefaultCompliance(&Params))) return false;
  Params.tool = Compliance.bTool;
  Params.layer = Compliance.bLayer;
  Params.mount = Compliance.bMount;
  // a figure of 0 keeps the library's default
  const auto Set = [](double Given, double& Value) {
    if (Given != 0.0) Value = Given;
  };
  const auto SetEach = [&Set](const FVector& Given, double* Values) {
    Set(Given.X, Values[0]);
    Set(Given.Y, Values[1]);
    Set(Given.Z, Values[2]);
  };
  Set(1e-3 * Compliance.Period_ms, Params.period_s);
  SetEach(Compliance.MountPoint * (1.0 / osteon::host::kUnreal.units_per_m), Params.mount_point_m);
  Set(Compliance.MountMass_kg, Params.mount_mass_kg);
  SetEach(Compliance.MountStiffness_N_per_m, Params.mount_stiffness_N_per_m);
  SetEach(Compliance.MountStiffness_Nm_per_rad, Params.mount_stiffness_Nm_per_rad);
  return Succeeds(HostSession.SetCompliance(Params));
}

FOsteonDeflection UOsteonBoneComponent::GetDeflection() {
  osteon::host::Deflection Found;
  FOsteonDeflection Deflection;
  if (!Succeeds(HostSession.GetDeflection(&Found))) return Deflection;
  Deflection.Bone = OsteonConvert::ToTransform(Found.bone);
  Deflection.Bend = OsteonConvert::ToVector(Found.bend);
  Deflection.Layer = OsteonConvert::ToVector(Found.layer);
  Deflection.Mount = OsteonConvert::ToVector(Found.mount);
  Deflection.bGivesWay = Found.gives_way;
  Deflection.bBeyondLimit = Found.beyond_limit;
  return Deflection;
}

bool UOsteonBoneComponent::ChangeTool(const FString& Name, double Diameter_mm, const FTransform& Pose) {
  const FTCHARToUTF8 NameText(*Name), FolderText(*ConfigFolder);
  return Succeeds(HostSession.ChangeTool(NameText.Get(), 1e-3 * Diameter_mm,
                                         ConfigFolder.IsEmpty() ? nullptr : FolderText.Get(),
                                         OsteonConvert::ToPose(Pose)));
}

bool UOsteonBoneComponent::Save(const FString& File) {
  return Succeeds(HostSession.Save(FTCHARToUTF8(*File).Get()));
}

bool UOsteonBoneComponent::Restore(const FString& File, const FTransform& Pose) {
  return Succeeds(HostSession.Restore(FTCHARToUTF8(*File).Get(), OsteonConvert::ToPose(Pose)));
}

bool UOsteonBoneComponent::ExportSurface(const FString& File) {
  return Succeeds(osteon_session_surface_export(HostSession.session(), FTCHARToUTF8(*File).Get(), nullptr));
}

bool UOsteonBoneComponent::Assess(const FString& Plan, const FString& Rubric, double& Score,
                                  TArray<FOsteonScoreItem>& Items) {
  const FTCHARToUTF8 PlanText(*Plan), RubricText(*Rubric), FolderText(*ConfigFolder);
  osteon::host::PlanParams Params;
  Params.plan = PlanText.Get();
  Params.rubric = Rubric.IsEmpty() ? nullptr : RubricText.Get();
  Params.config_folder = ConfigFolder.IsEmpty() ? nullptr : FolderText.Get();
  osteon::host::Plan HostPlan(osteon::host::kUnreal);
  osteon::host::Assessment Found;
  Items.Empty();
  Score = 0.0;
  if (!Succeeds(HostPlan.Open(Params)) || !Succeeds(HostPlan.Assess(HostSession, &Found))) return false;
  Score = Found.values.score;
  for (const OsteonScoreItem& Row : Found.items) {
    FOsteonScoreItem Item;
    Item.Metric = UTF8_TO_TCHAR(Row.metric);
    Item.Unit = UTF8_TO_TCHAR(Row.unit);
    Item.Value = Row.value;
    Item.Weight = Row.weight;
    Item.Points = Row.points;
    Items.Add(Item);
  }
  return true;
}

FTransform UOsteonBoneComponent::Approach(double Height_cm) {
  osteon::host::Pose Pose;
  Succeeds(HostSession.Approach(Height_cm / osteon::host::kUnreal.units_per_m, &Pose));
  return OsteonConvert::ToTransform(Pose);
}

double UOsteonBoneComponent::GetRemovedVolume_mm3() {
  OsteonFigures Figures{};
  Succeeds(osteon_session_figures(HostSession.session(), &Figures));
  return 1e9 * Figures.removed_volume_m3;
}

bool UOsteonBoneComponent::Mark() { return Succeeds(osteon_session_mark(HostSession.session())); }

bool UOsteonBoneComponent::Undo(const FTransform& Pose) {
  return Succeeds(HostSession.Undo(OsteonConvert::ToPose(Pose)));
}

void UOsteonBoneComponent::UpdateMesh() {
  std::vector<osteon::host::Brick> Changed;
  Succeeds(HostSession.TakeChangedBricks(&Changed));
  for (const osteon::host::Brick& Brick : Changed) {
    // each brick keeps the mesh section that it was given when it first appeared
    const int32* Known = Sections.Find(Brick.number);
    const int32 Section = Known ? *Known : Sections.Num();
    if (!Known) Sections.Add(Brick.number, Section);
    const OsteonConvert::FSection Mesh = OsteonConvert::ToSection(Brick);
    if (Mesh.Triangles.Num() == 0)
      ClearMeshSection(Section);
    else
      CreateMeshSection(Section, Mesh.Vertices, Mesh.Triangles, Mesh.Normals, TArray<FVector2D>(),
                        Mesh.Colors, TArray<FProcMeshTangent>(), false);
  }
}

void UOsteonBoneComponent::TellEvents() {
  OsteonEvent Event;
  while (osteon_session_next_event(HostSession.session(), &Event) == OSTEON_OK) {
    const double* P = Event.position_m;
    const FVector Position =
        OsteonConvert::ToVector(osteon::host::PositionToHost(osteon::host::kUnreal, {P[0], P[1], P[2]}));
    OnSceneEvent.Broadcast(UTF8_TO_TCHAR(Event.name), 1e3 * Event.value_m, Position);
  }
}

bool UOsteonBoneComponent::Succeeds(OsteonResult Result) {
  return OsteonSucceeds(Result, LastRefusal, OnRefused);
}
