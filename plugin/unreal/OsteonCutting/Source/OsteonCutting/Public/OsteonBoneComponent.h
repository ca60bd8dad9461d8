#pragma once

#include "Components/SceneComponent.h"
#include "CoreMinimal.h"
#include "OsteonTypes.h"
#include "ProceduralMeshComponent.h"
#include "osteon_host.h"

#include "OsteonBoneComponent.generated.h"

/// A bone that a tool cuts: a procedural mesh that follows the cut, with one section per brick of the
/// surface.
///
/// Lengths and positions are in Unreal's axes and centimetres, in this component's own frame; forces are in
/// newtons. Set the properties and name the tool's component; the bone is opened when play begins. A haptic
/// device's own thread may call Session().SetToolPose and Session().Evaluate, which never wait.
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
  /// Diameter in millimetres; 0: the tool's usual one.
  UPROPERTY(EditAnywhere, BlueprintReadWrite, Category = "Osteon")
  double ToolDiameter_mm = 0.0;
  /// Largest force [N] that the hand is given: above 0, at most 200.
  UPROPERTY(EditAnywhere, BlueprintReadWrite, Category = "Osteon")
  double MaxForce_N = 200.0;
  /// Folder of scenes/, tools/ and materials/; empty: that of the library.
  UPROPERTY(EditAnywhere, BlueprintReadWrite, Category = "Osteon")
  FString ConfigFolder;
  /// Whether the spindle turns.
  UPROPERTY(EditAnywhere, BlueprintReadWrite, Category = "Osteon")
  bool bSpins = true;
  /// Component whose origin is the tool's apex and whose +z is the feed. None: the poses are set by
  /// SetToolPose.
  UPROPERTY(EditAnywhere, BlueprintReadWrite, Category = "Osteon")
  USceneComponent* Tool = nullptr;

  /// A call was refused; the text says what was found and what is accepted. If the same text repeats, it is
  /// sent only once.
  UPROPERTY(BlueprintAssignable, Category = "Osteon")
  FOsteonRefused OnRefused;

  /// An event that the scene watches for has occurred, such as "breakthrough" or "wall too thin". Sent by the
  /// component's tick.
  UPROPERTY(BlueprintAssignable, Category = "Osteon")
  FOsteonSceneEvent OnSceneEvent;

  /// Opens bone, tool and session with the values of the properties; closes an open session first.
  UFUNCTION(BlueprintCallable, Category = "Osteon")
  bool Open();
  UFUNCTION(BlueprintCallable, Category = "Osteon")
  void Close();
  UFUNCTION(BlueprintPure, Category = "Osteon")
  bool IsOpen() const { return HostSession.IsOpen(); }

  /// The engine that computes the frames, such as "cpu on one thread, …".
  UFUNCTION(BlueprintPure, Category = "Osteon")
  FString GetEngine() const;
  /// The assumptions that were needed to make a solid from the bone's mesh; empty: none. They are logged as
  /// well.
  UFUNCTION(BlueprintPure, Category = "Osteon")
  FString GetBoneWarning() const;
  UFUNCTION(BlueprintPure, Category = "Osteon")
  static FString GetLibraryVersion();

  /// Sets the tool's pose, in this component's frame.
  UFUNCTION(BlueprintCallable, Category = "Osteon")
  bool SetToolPose(const FTransform& Pose);
  /// The force [N] that the hand should feel from a tool at rest at this pose.
  UFUNCTION(BlueprintCallable, Category = "Osteon")
  FVector GetForce(const FTransform& Pose);
  /// Computes force [N] and torque [N·m] on a moving tool. Velocity is that of the apex [cm/s],
  /// AngularVelocity in rad/s.
  UFUNCTION(BlueprintCallable, Category = "Osteon")
  bool GetWrench(const FTransform& Pose, const FVector& Velocity, const FVector& AngularVelocity,
                 FVector& Force_N, FVector& Torque_Nm);
  /// Turns on the compliance of the chosen parts (tool, soft tissue, mount), from the next GetForce or
  /// GetWrench on.
  UFUNCTION(BlueprintCallable, Category = "Osteon")
  bool SetCompliance(const FOsteonCompliance& Compliance);
  /// Displacements of the compliant parts after the last GetForce or GetWrench.
  UFUNCTION(BlueprintCallable, Category = "Osteon")
  FOsteonDeflection GetDeflection();
  /// Changes to another tool at this pose, which must be free of bone. Diameter 0: the tool's usual diameter.
  UFUNCTION(BlueprintCallable, Category = "Osteon")
  bool ChangeTool(const FString& Name, double Diameter_mm, const FTransform& Pose);
  /// Saves the carved bone.
  UFUNCTION(BlueprintCallable, Category = "Osteon")
  bool Save(const FString& File);
  /// Returns to a saved bone. The tool's pose must be free of the saved bone.
  UFUNCTION(BlueprintCallable, Category = "Osteon")
  bool Restore(const FString& File, const FTransform& Pose);
  /// Writes the carved bone as one mesh in millimetres, in Osteon's axes: .stl, .ply or .obj.
  UFUNCTION(BlueprintCallable, Category = "Osteon")
  bool ExportSurface(const FString& File);
  /// Compares the bone in its present state with a plan ("acetabulum", or a YAML file); takes 0.1 s. If the
  /// rubric is empty, that of the plan's kind is used.
  UFUNCTION(BlueprintCallable, Category = "Osteon")
  bool Assess(const FString& Plan, const FString& Rubric, double& Score, TArray<FOsteonScoreItem>& Items);
  /// Returns a pose of the tool that points into the site, with the apex Height_cm above the site's centre.
  UFUNCTION(BlueprintCallable, Category = "Osteon")
  FTransform Approach(double Height_cm);
  UFUNCTION(BlueprintCallable, Category = "Osteon")
  double GetRemovedVolume_mm3();
  /// Marks the present state of the bone for Undo.
  UFUNCTION(BlueprintCallable, Category = "Osteon")
  bool Mark();
  /// Returns to the last mark. The tool's pose must be free of the bone in that state.
  UFUNCTION(BlueprintCallable, Category = "Osteon")
  bool Undo(const FTransform& Pose);
  /// Updates the mesh from the newest surface; called in each tick.
  UFUNCTION(BlueprintCallable, Category = "Osteon")
  void UpdateMesh();

  /// The session itself, for a haptic device's thread.
  osteon::host::Session& Session() { return HostSession; }

  void BeginPlay() override;
  void EndPlay(const EEndPlayReason::Type Reason) override;
  void TickComponent(float DeltaTime, ELevelTick TickType,
                     FActorComponentTickFunction* ThisTickFunction) override;

 private:
  // Whether a call succeeded; logs and broadcasts a refusal (OsteonRefusal.h).
  bool Succeeds(OsteonResult Result);
  // Broadcasts the scene's events that have occurred since the last tick.
  void TellEvents();

  osteon::host::Session HostSession{osteon::host::kUnreal};
  TMap<uint32, int32> Sections;  // index of the mesh section by the brick's number
  FString LastRefusal;
};
