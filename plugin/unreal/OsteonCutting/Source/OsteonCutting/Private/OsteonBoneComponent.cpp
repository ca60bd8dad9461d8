#include "OsteonBoneComponent.h"

#include <vector>

#include "OsteonConvert.h"

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
  return Succeeds(HostSession.Open(Params));
}

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

bool UOsteonBoneComponent::Succeeds(OsteonResult Result) {
  if (Result == OSTEON_OK) return true;
  const FString Text = UTF8_TO_TCHAR(osteon_last_error());
  if (Text != LastRefusal) {
    LastRefusal = Text;
    UE_LOG(LogTemp, Warning, TEXT("Osteon: %s"), *Text);
    OnRefused.Broadcast(Text);
  }
  return false;
}
