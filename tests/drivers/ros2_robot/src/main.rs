//! Publishes the rows that it reads as joint states, and prints the estimates that it receives.
//!
//! ros2-robot RELIABILITY JOINT... < ROWS
//! A row has the stamp [ns], then position and effort of each joint. It is published as soon as it
//! is read; a row of zero length stands for nothing. It ends some time after the last row.

use std::{env, io, time::Duration};

use futures::{FutureExt, StreamExt};
use ros2_client::{
    builtin_interfaces::Time, qos::History, qos::WhenFull, Context, Message, MessageTypeName, Name,
    NodeName, NodeOptions, QosProfile,
};
use serde::{Deserialize, Serialize};

#[derive(Clone, Debug, Serialize, Deserialize)]
struct Header {
    stamp: Time,
    frame_id: String,
}

#[derive(Clone, Debug, Serialize, Deserialize)]
struct JointState {
    header: Header,
    name: Vec<String>,
    position: Vec<f64>,
    velocity: Vec<f64>,
    effort: Vec<f64>,
}
impl Message for JointState {}

#[derive(Clone, Debug, Serialize, Deserialize)]
struct InterfaceValue {
    interface_names: Vec<String>,
    values: Vec<f64>,
}

#[derive(Clone, Debug, Serialize, Deserialize)]
struct DynamicJointState {
    header: Header,
    joint_names: Vec<String>,
    interface_values: Vec<InterfaceValue>,
}
impl Message for DynamicJointState {}

#[derive(Clone, Debug, Serialize, Deserialize)]
struct KeyValue {
    key: String,
    value: String,
}

#[derive(Clone, Debug, Serialize, Deserialize)]
struct DiagnosticStatus {
    level: u8,
    name: String,
    message: String,
    hardware_id: String,
    values: Vec<KeyValue>,
}

#[derive(Clone, Debug, Serialize, Deserialize)]
struct DiagnosticArray {
    header: Header,
    status: Vec<DiagnosticStatus>,
}
impl Message for DiagnosticArray {}

const AFTER_THE_LAST_ROW: Duration = Duration::from_secs(3);

fn main() {
    let arguments: Vec<String> = env::args().skip(1).collect();
    let (reliability, joints) = arguments.split_first().expect("RELIABILITY JOINT...");
    let queue = History::KeepLast { depth: 5000 };
    let reliable = QosProfile::publisher_default()
        .reliability_reliable(WhenFull::DEFAULT)
        .history(queue);
    let best_effort = QosProfile::subscription_default().history(queue);
    let ours = match reliability.as_str() {
        "reliable" => reliable.clone(),
        _ => best_effort,
    };

    let context = Context::new().unwrap();
    let name = NodeName::new("/", "robot").unwrap();
    let mut node = context.new_node(name, NodeOptions::new()).unwrap();
    let topic = |name: &str, package: &str, kind: &str, qos: &QosProfile| {
        let name = Name::new("/", name).unwrap();
        node.create_topic(&name, MessageTypeName::new(package, kind), qos).unwrap()
    };
    let states = topic("joint_states", "sensor_msgs", "JointState", &ours);
    let namespace = Name::new("/sigmahat", "estimates").unwrap();
    let diagnostics = topic("diagnostics", "diagnostic_msgs", "DiagnosticArray", &reliable);
    let kind = MessageTypeName::new("control_msgs", "DynamicJointState");
    let estimates = node.create_topic(&namespace, kind, &reliable).unwrap();
    let publisher = node.create_publisher::<JointState>(&states, Some(ours)).unwrap();
    let estimated = node
        .create_subscription::<DynamicJointState>(&estimates, Some(reliable.clone()))
        .unwrap();
    let diagnosed = node
        .create_subscription::<DiagnosticArray>(&diagnostics, Some(reliable))
        .unwrap();

    let executor = smol::Executor::new();
    executor.spawn(node.spinner().unwrap().spin()).detach();
    let print_estimates = estimated.async_stream().for_each(|received| async {
        let (message, _) = received.unwrap();
        let t = message.header.stamp.to_nanos();
        for (joint, state) in message.joint_names.iter().zip(&message.interface_values) {
            let pairs = state.interface_names.iter().zip(&state.values);
            let values: Vec<String> = pairs.map(|(name, value)| format!("{name} {value:?}")).collect();
            println!("estimate {t} {joint} {}", values.join(" "));
        }
    });
    let print_diagnostics = diagnosed.async_stream().for_each(|received| async {
        let (message, _) = received.unwrap();
        for status in message.status {
            println!("diagnosis {} {}: {}", status.level, status.name, status.message);
        }
    });
    let publish = async {
        publisher.wait_for_subscription(&node).await;
        eprintln!("somebody listens");
        let rows = smol::Unblock::new(io::stdin());
        let mut lines = futures::io::AsyncBufReadExt::lines(futures::io::BufReader::new(rows));
        while let Some(row) = lines.next().await {
            let row = row.unwrap();
            let (stamp, values) = row.split_once(' ').unwrap();
            let values: Vec<f64> = values.split(' ').map(|each| each.parse().unwrap()).collect();
            let message = JointState {
                header: Header {
                    stamp: Time::from_nanos(stamp.parse().unwrap()),
                    frame_id: String::new(),
                },
                name: joints.to_vec(),
                position: values.iter().step_by(2).copied().collect(),
                velocity: vec![],
                effort: values.iter().skip(1).step_by(2).copied().collect(),
            };
            publisher.publish(message).unwrap();
        }
        smol::Timer::after(AFTER_THE_LAST_ROW).await;
    };
    let receive = futures::future::join(print_estimates, print_diagnostics);
    smol::block_on(executor.run(async {
        futures::select! { _ = publish.fuse() => (), _ = receive.fuse() => () }
    }));
}
