package osteon;

import static com.kuka.roboticsAPI.motionModel.BasicMotions.positionHold;

import java.util.concurrent.TimeUnit;
import java.util.concurrent.TimeoutException;

import javax.inject.Inject;

import com.kuka.connectivity.fastRobotInterface.ClientCommandMode;
import com.kuka.connectivity.fastRobotInterface.FRIChannelInformation;
import com.kuka.connectivity.fastRobotInterface.FRIConfiguration;
import com.kuka.connectivity.fastRobotInterface.FRIJointOverlay;
import com.kuka.connectivity.fastRobotInterface.FRISession;
import com.kuka.connectivity.fastRobotInterface.IFRISessionListener;
import com.kuka.roboticsAPI.applicationModel.RoboticsAPIApplication;
import com.kuka.roboticsAPI.deviceModel.LBR;
import com.kuka.roboticsAPI.geometricModel.CartDOF;
import com.kuka.roboticsAPI.geometricModel.Tool;
import com.kuka.roboticsAPI.motionModel.IMotionContainer;
import com.kuka.roboticsAPI.motionModel.controlModeModel.AbstractMotionControlMode;
import com.kuka.roboticsAPI.motionModel.controlModeModel.CartesianImpedanceControlMode;
import com.kuka.roboticsAPI.motionModel.controlModeModel.JointImpedanceControlMode;
import com.kuka.roboticsAPI.motionModel.controlModeModel.PositionControlMode;
import com.kuka.roboticsAPI.uiModel.userKeys.IUserKey;
import com.kuka.roboticsAPI.uiModel.userKeys.IUserKeyBar;
import com.kuka.roboticsAPI.uiModel.userKeys.IUserKeyListener;
import com.kuka.roboticsAPI.uiModel.userKeys.UserKeyAlignment;
import com.kuka.roboticsAPI.uiModel.userKeys.UserKeyEvent;

/**
 * The arm's half of an Osteon cell: opens an FRI session to the PC, and on a key holds the arm where it is while the PC
 * moves it by an overlay. It commands no motion of its own.
 *
 * Written from public documentation for Sunrise.OS 1.11 to 1.16 (FRI 1.x); NOT TESTED ON A CONTROLLER. Nothing here is a
 * safety function: safety configuration, enabling device and emergency stop are the controller's. What differs in
 * Sunrise.OS 2 is in the README two folders up.
 *
 * User keys: "Begin" hands the arm over, "End" takes it back and ends the application.
 */
public class OsteonHaptics extends RoboticsAPIApplication {
  // These values must agree with the cell's YAML on the PC.
  /** The PC's network card toward the controller; the cell's fri: host. KONI's own address is 192.170.10.2. */
  private static final String CLIENT_ADDRESS = "192.170.10.10";
  /** 30200 to 30209; the cell's fri: port. */
  private static final int CLIENT_PORT = 30200;
  /** 1, 2, 5 or 10; the cell's fri: period_ms. */
  private static final int SEND_PERIOD_MS = 1;
  /** The PC answers each so many messages; the cell's fri: receive_multiplier_count. */
  private static final int RECEIVE_MULTIPLIER = 1;
  /** POSITION (admittance), or WRENCH or TORQUE (impedance). */
  private static final ClientCommandMode MODE = ClientCommandMode.POSITION;

  // The load on the flange: sensor and tool. The template carries load data and a default motion frame at the tool's
  // apex; its mass is checked, as an arm with a wrong load drifts in impedance control.
  private static final String TOOL_TEMPLATE = "OsteonReamer";
  private static final double PAYLOAD_KG = 1.38;
  private static final double PAYLOAD_TOLERANCE_KG = 0.05;

  // The impedance that WRENCH (Cartesian) and TORQUE (joints) are added to.
  private static final double STIFFNESS_N_PER_M = 2000.0;
  private static final double STIFFNESS_NM_PER_RAD = 200.0;
  private static final double JOINT_STIFFNESS_NM_PER_RAD = 500.0;
  private static final double DAMPING_RATIO = 0.7;

  private static final int GOOD_TIMEOUT_S = 10;
  private static final int CANCEL_TIMEOUT_MS = 5000;
  private static final int POLL_MS = 20;

  @Inject
  private LBR lbr;

  private Tool tool;
  private FRISession session;
  // Set by the keys' thread, read by run().
  private volatile boolean begin;
  private volatile boolean end;

  /** States and quality as they change: what the log shows when a run has gone wrong. */
  private final IFRISessionListener listener = new IFRISessionListener() {
    @Override
    public void onFRISessionStateChanged(FRIChannelInformation channel) {
      getLogger().info("FRI state " + channel.getFRISessionState() + ", " + describe(channel));
    }

    @Override
    public void onFRIConnectionQualityChanged(FRIChannelInformation channel) {
      getLogger().info("FRI connection " + describe(channel));
    }
  };

  @Override
  public void initialize() {
    tool = getApplicationData().createFromTemplate(TOOL_TEMPLATE);
    tool.attachTo(lbr.getFlange());

    // Keys can be made here alone, not once run() has begun.
    IUserKeyBar bar = getApplicationUI().createUserKeyBar("Osteon");
    IUserKey beginKey = bar.addUserKey(0, new IUserKeyListener() {
      @Override
      public void onKeyEvent(IUserKey key, UserKeyEvent event) {
        if (event == UserKeyEvent.KeyDown) begin = true;
      }
    }, true);
    beginKey.setText(UserKeyAlignment.Middle, "Begin");
    IUserKey endKey = bar.addUserKey(1, new IUserKeyListener() {
      @Override
      public void onKeyEvent(IUserKey key, UserKeyEvent event) {
        if (event == UserKeyEvent.KeyDown) end = true;
      }
    }, true);
    endKey.setText(UserKeyAlignment.Middle, "End");
    bar.publish();
  }

  @Override
  public void run() throws Exception {
    if (!parametersAreRight()) return;

    FRIConfiguration configuration = FRIConfiguration.createRemoteConfiguration(lbr, CLIENT_ADDRESS);
    configuration.setPortOnRemote(CLIENT_PORT);
    configuration.setSendPeriodMilliSec(SEND_PERIOD_MS);
    configuration.setReceiveMultiplier(RECEIVE_MULTIPLIER);
    getLogger().info("Osteon: FRI to " + CLIENT_ADDRESS + ":" + CLIENT_PORT + " each " + SEND_PERIOD_MS
        + " ms, answered each " + RECEIVE_MULTIPLIER + ", command mode " + MODE);

    // From here on the arm sends.
    session = new FRISession(configuration);
    session.addFRISessionListener(listener);
    try {
      session.await(GOOD_TIMEOUT_S, TimeUnit.SECONDS);
    } catch (TimeoutException timeout) {
      getLogger().error("No GOOD connection within " + GOOD_TIMEOUT_S + " s: " + timeout.getMessage()
          + ". Does osteon run on " + CLIENT_ADDRESS + ", with this port, and this FRI version in its cell?");
      return;
    }

    getLogger().info("Connected, " + describe(session.getFRIChannelInformation())
        + ". Key Begin hands the arm over, End ends.");
    while (!begin && !end) Thread.sleep(POLL_MS);
    if (!end) follow();
  }

  /** Holds the arm where it stands, with the PC's overlay on top, until the key End, or until the motion ends. */
  private void follow() throws InterruptedException {
    FRIJointOverlay overlay = new FRIJointOverlay(session, MODE);
    // Without end; the wrench acts at the frame that is moved: the tool's default motion frame.
    IMotionContainer motion = tool.getDefaultMotionFrame().moveAsync(
        positionHold(controlMode(), -1, TimeUnit.SECONDS).addMotionOverlay(overlay));
    try {
      while (!end && !motion.isFinished()) Thread.sleep(POLL_MS);
      if (motion.isFinished())
        getLogger().error("The motion ended by itself: " + motion.getErrorMessage() + "; "
            + describe(session.getFRIChannelInformation()));
    } finally {
      cancel(motion);
    }
  }

  /** Ends the overlay. The arm stays where it is then: the PC sees COMMANDING_ACTIVE end. */
  private void cancel(IMotionContainer motion) throws InterruptedException {
    if (motion.isFinished()) return;
    motion.cancel();
    long deadline = System.nanoTime() + TimeUnit.MILLISECONDS.toNanos(CANCEL_TIMEOUT_MS);
    while (!motion.isFinished() && System.nanoTime() < deadline) Thread.sleep(POLL_MS);
    if (!motion.isFinished())
      getLogger().error("The motion has not ended " + CANCEL_TIMEOUT_MS + " ms after it was cancelled.");
  }

  /** WRENCH is accepted in Cartesian impedance alone, TORQUE in joint impedance. */
  private AbstractMotionControlMode controlMode() {
    switch (MODE) {
      case WRENCH: {
        CartesianImpedanceControlMode cartesian = new CartesianImpedanceControlMode();
        cartesian.parametrize(CartDOF.TRANSL).setStiffness(STIFFNESS_N_PER_M);
        cartesian.parametrize(CartDOF.ROT).setStiffness(STIFFNESS_NM_PER_RAD);
        cartesian.parametrize(CartDOF.ALL).setDamping(DAMPING_RATIO);
        return cartesian;
      }
      case TORQUE: {
        JointImpedanceControlMode joints = new JointImpedanceControlMode(lbr.getJointCount());
        joints.setStiffnessForAllJoints(JOINT_STIFFNESS_NM_PER_RAD);
        joints.setDampingForAllJoints(DAMPING_RATIO);
        return joints;
      }
      default:
        return new PositionControlMode();
    }
  }

  /** Says what is wrong, before the arm is handed to anybody. */
  private boolean parametersAreRight() {
    if (SEND_PERIOD_MS != 1 && SEND_PERIOD_MS != 2 && SEND_PERIOD_MS != 5 && SEND_PERIOD_MS != 10) {
      getLogger().error("SEND_PERIOD_MS: found " + SEND_PERIOD_MS + ", accepted 1, 2, 5, 10");
      return false;
    }
    if (CLIENT_PORT < 30200 || CLIENT_PORT > 30209) {
      getLogger().error("CLIENT_PORT: found " + CLIENT_PORT + ", accepted 30200 to 30209");
      return false;
    }
    double mass = tool.getLoadData().getMass();
    if (!(Math.abs(mass - PAYLOAD_KG) <= PAYLOAD_TOLERANCE_KG)) {
      getLogger().error("Load of " + TOOL_TEMPLATE + ": found " + mass + " kg, accepted " + PAYLOAD_KG + " +- "
          + PAYLOAD_TOLERANCE_KG + "; determine the load data, then set both");
      return false;
    }
    return true;
  }

  private static String describe(FRIChannelInformation channel) {
    return "quality " + channel.getQuality() + ", jitter " + channel.getJitter() + ", latency "
        + channel.getLatency();
  }

  @Override
  public void dispose() {
    try {
      if (session != null) session.close();  // takes about five seconds
    } finally {
      super.dispose();
    }
  }

  public static void main(String[] arguments) {
    new OsteonHaptics().runApplication();
  }
}
