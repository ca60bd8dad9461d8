#pragma once

#include "Components/SceneComponent.h"
#include "CoreMinimal.h"
#include "ProceduralMeshComponent.h"
#include "osteon_host.h"

#include "OsteonBoneComponent.generated.h"

DECLARE_DYNAMIC_MULTICAST_DELEGATE_OneParam(FOsteonRefused, const FString&, Text);

/// A bone that a tool cuts: a procedural mesh, one section a brick of the surface, that follows the cut.
///
/// Lengths and places are Unreal's, in centimetres, in this component's own frame; forces are newtons. Set
/// the properties, name the tool's component, and the bone is opened when play begins. A haptic device's own
/// thread may call Session().SetToolPose and Evaluate, which never wait.
UCLASS(ClassGroup = (Osteon), meta = (BlueprintSpawnableComponent))
class OSTEONCUTTING_API UOsteonBoneComponent : public UProceduralMeshComponent {
  GENERATED_BODY()

 public:
  UOsteonBoneComponent(const FObjectInitializer& Initializer);

  /// A shipped scene: acetabulum, molar, femoral_canal, …
  UPROPERTY(EditAnywhere, BlueprintReadWrite, Category = "Osteon")
  FString Scene = TEXT("acetabulum");
  /// A shipped tool: reamer, twist_drill, round_burr, …
  UPROPERTY(EditAnywhere, BlueprintReadWrite, Category = "Osteon")
  FString ToolName = TEXT("reamer");
  /// In millimetres; 0: the tool's usual one.
  UPROPERTY(EditAnywhere, BlueprintReadWrite, Category = "Osteon")
  double ToolDiameter_mm = 0.0;
  /// Largest force of the hand: above 0, at most 200.
  UPROPERTY(EditAnywhere, BlueprintReadWrite, Category = "Osteon")
  double MaxForce_N = 200.0;
  /// Folder of scenes/, tools/ and materials/; empty: that of the library.
  UPROPERTY(EditAnywhere, BlueprintReadWrite, Category = "Osteon")
  FString ConfigFolder;
  /// Whether the spindle turns.
  UPROPERTY(EditAnywhere, BlueprintReadWrite, Category = "Osteon")
  bool bSpins = true;
  /// Its origin is the tool's apex, its +z the feed. None: poses come by SetToolPose.
  UPROPERTY(EditAnywhere, BlueprintReadWrite, Category = "Osteon")
  USceneComponent* Tool = nullptr;

  /// Something was refused; the text says what was found and what is accepted. Each text once in a row.
  UPROPERTY(BlueprintAssignable, Category = "Osteon")
  FOsteonRefused OnRefused;

  /// Opens bone, tool and session by the properties; what was open is closed.
  UFUNCTION(BlueprintCallable, Category = "Osteon")
  bool Open();
  UFUNCTION(BlueprintCallable, Category = "Osteon")
  void Close();
  UFUNCTION(BlueprintPure, Category = "Osteon")
  bool IsOpen() const { return HostSession.IsOpen(); }

  /// Where the tool is, in this component's frame.
  UFUNCTION(BlueprintCallable, Category = "Osteon")
  bool SetToolPose(const FTransform& Pose);
  /// The force [N] that the hand should feel at this pose.
  UFUNCTION(BlueprintCallable, Category = "Osteon")
  FVector GetForce(const FTransform& Pose);
  /// A pose that points into the site, its apex Height_cm above the site's centre.
  UFUNCTION(BlueprintCallable, Category = "Osteon")
  FTransform Approach(double Height_cm);
  UFUNCTION(BlueprintCallable, Category = "Osteon")
  double GetRemovedVolume_mm3();
  /// Remembers the bone for Undo.
  UFUNCTION(BlueprintCallable, Category = "Osteon")
  bool Mark();
  /// Returns to the last mark; the tool, at this pose, must be free of the bone that comes back.
  UFUNCTION(BlueprintCallable, Category = "Osteon")
  bool Undo(const FTransform& Pose);
  /// Brings the mesh up to date; each tick does.
  UFUNCTION(BlueprintCallable, Category = "Osteon")
  void UpdateMesh();

  osteon::host::Session& Session() { return HostSession; }

  void BeginPlay() override;
  void EndPlay(const EEndPlayReason::Type Reason) override;
  void TickComponent(float DeltaTime, ELevelTick TickType,
                     FActorComponentTickFunction* ThisTickFunction) override;

 private:
  bool Succeeds(OsteonResult Result);

  osteon::host::Session HostSession{osteon::host::kUnreal};
  TMap<uint32, int32> Sections;  // by the brick's number
  FString LastRefusal;
};
